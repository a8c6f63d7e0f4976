#!/usr/bin/env bash
# `cmake --install` to a folder with a space in its name; the installed cairn finds cairn-worker beside it.
source "$(dirname "$0")/common.sh"

cmake --install "${CAIRN_BUILD:?}" --prefix "$work/a prefix" >install.log || die "$(cat install.log)"
PATH="$work/a prefix/bin:/usr/bin:/bin"
exits 0 cairn --version
simulate log.h5
exits 0 cairn run landmark_map log.h5 --set iterations=1 --out result --workers 1
says 'report.html'
mv "$work/a prefix/bin/cairn-worker" "$work/elsewhere"
exits 1 cairn run landmark_map log.h5 --out result2
says 'cairn-worker is missing'
