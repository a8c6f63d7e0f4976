#!/usr/bin/env bash
# cairn page looks on while a store is lost and a backup restored: of a job that gets the number of one that is gone it shows
# the results and the rounds, and of the other nothing.
source "$(dirname "$0")/common.sh"

command -v python3 >/dev/null || skip "there is no python3"
simulate one.h5
simulate other.h5 8
exits 0 python3 "$(dirname "$0")/page_restored.py"
cat stdout
