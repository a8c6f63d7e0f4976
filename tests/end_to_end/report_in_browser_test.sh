#!/usr/bin/env bash
# A report's maps in a real browser: one looks around in them, hides layers, moves the sliders, points at things and saves what is
# there; two beside each other are looked at together. An error in the browser's console fails it.
source "$(dirname "$0")/common.sh"

command -v chromium >/dev/null || skip "no chromium here (deploy/install.sh --browser)"
command -v chromedriver >/dev/null || skip "no chromedriver here (deploy/install.sh --browser)"
command -v python3 >/dev/null || skip "there is no python3"
here=$(cd "$(dirname "$0")" && pwd)

exits 0 cairn simulate loop --difficulty paper --robots 2 --seed 3 log.h5
exits 0 cairn run landmark_map log.h5 --out one --workers 2
exits 0 cairn run landmark_map log.h5 --out other --workers 2 --set starts=1 --set refine=false
exits 0 cairn report one --log log.h5 --force
exits 0 cairn report one --beside other --log log.h5
exits 0 cairn simulate hallway --door-readings 1 --seed 102 hall.h5
exits 0 cairn run evidence_map hall.h5 --out hall --workers 2
exits 0 cairn run forward_map hall.h5 --out forward --workers 2
exits 0 python3 "$here/report_walk.py"
cat stdout
