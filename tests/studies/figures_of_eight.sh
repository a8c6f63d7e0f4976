#!/usr/bin/env bash
# Figures of eight as a person logs them, of every seed under four drifts: the path's error in metres, that of plain least
# squares that knows which landmark is which, and Cairn's verdict. Needs python3 with numpy, scipy and h5py.
#   tests/studies/figures_of_eight.sh [named|nameless [FIRST [LAST]]]     nameless 61 64: some ten minutes of a core
set -euo pipefail
here=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$here/build/release/bin:$PATH
kind=${1:-nameless} first=${2:-61} last=${3:-64}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

quietly() { "$@" >said 2>&1 || { cat said >&2; exit 1; }; }
scales=(0.97 1.0 1.02 1.03 1.05)
for seed in $(seq "$first" "$last"); do
  for drift in 0.1 0.3 0.8 1.5; do
    world=(--seed "$seed" --drift "$drift" --scale "${scales[$(((seed + 10#${drift/./}) % 5))]}")
    peer=$("$here/tests/studies/figure_of_eight.py" log "${world[@]}")
    quietly cairn import csv --odometry log/odometry.csv --observations "log/$kind.csv" log.h5 --force
    quietly cairn run landmark_map log.h5 --out map --force
    verdict=$(grep -oE '(high|fair|low|not known): .*' said | tail -1)
    error=$("$here/tests/studies/figure_of_eight.py" log "${world[@]}" --result map)
    echo "$seed $drift: $error; ${peer%% m,*} m; $verdict"
  done
done
