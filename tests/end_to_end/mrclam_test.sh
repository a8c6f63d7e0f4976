#!/usr/bin/env bash
# Real robots: MRCLAM 1 and 6, five robots, fifteen landmarks with identities (docs/datasets.md).
source "$(dirname "$0")/common.sh"
[ -n "${CAIRN_DATA:-}" ] && [ -d "$CAIRN_DATA/mrclam6" ] || skip "CAIRN_DATA names no folder that holds mrclam6"

map() {
  exits 0 cairn import mrclam "$CAIRN_DATA/$1" "$1.h5"
  exits 0 cairn run landmark_map "$1.h5" --out "$1" --workers 2
  exits 0 cairn evaluate "$1" --truth "$1.h5" --json
  [ "$(number found stdout)" -eq 15 ] || die "$1: not all fifteen landmarks were found: $(cat stdout)"
  [ "$(number spurious stdout)" -eq 0 ] || die "$1: landmarks that are not there"
  below "$(number rmse_m stdout)" "$2"
  cp stdout "$1.json"
}
map mrclam1 0.13
map mrclam6 0.10

# Where the path is known it must be right too: a good map can hide a wrong path.
worst=$(tr -d ' \n' <mrclam6.json | grep -oE '"trajectory":\{[^[]*"rmse_m":[0-9.]+' | grep -oE '[0-9.]+$')
below "$worst" 0.25

# Times that run backwards: named, or skipped and counted.
if [ -d "$CAIRN_DATA/mrclam9" ]; then
  refuses ':[0-9]+: .*backwards' cairn import mrclam "$CAIRN_DATA/mrclam9" mrclam9.h5
  exits 0 cairn import mrclam --skip-bad "$CAIRN_DATA/mrclam9" mrclam9.h5
  says 'backwards'
  exits 0 cairn run landmark_map mrclam9.h5 --out mrclam9 --workers 2
  exits 0 cairn evaluate mrclam9 --truth mrclam9.h5 --json
  below "$(number rmse_m stdout)" 0.30
fi
