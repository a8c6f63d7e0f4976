#!/usr/bin/env bash
# The ways to train, compared on one simulated corridor that no setting was chosen on: error reduction reached on the runs
# trained on, and on a run that nothing saw, and the processor time that two workers and their coordinator took.
#   tests/studies/training_methods.sh [SET [SEED]]     d1, d2 or d3; a seed. CAIRN_BIN: the folder of the programs.
#   STEPS: of each way, instead of its own
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source-path=SCRIPTDIR
source "$here/common.sh"
PATH=$(realpath "${CAIRN_BIN:-$here/../../build/release/bin}"):$PATH
TIMEFORMAT='%U %S'
set=${1:-d1} seed=${2:-21}
work=$(mktemp -d "${TMPDIR:-/tmp}/ways XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"

cairn simulate corridor --set "$set" --seed "$seed" --runs 3 --snapshots 808 trained.h5 >/dev/null
cairn simulate corridor --set "$set" --seed "$seed" --runs 4 --snapshots 808 all.h5 >/dev/null

printf '%-34s %7s %10s %10s %8s\n' "way (164-6-1, n = 4, ±2 m, $set)" steps trained unseen 'cpu s'
way() { # NAME STEPS SETTINGS…
  local name=$1 steps=${STEPS:-$2} trained unseen seconds
  shift 2
  local settings=()
  for setting in "$@"; do settings+=(--set "$setting"); done
  { time cairn run landmark_learning trained.h5 --workers 2 --force --out "$work/out" --set "steps=$steps" \
    "${settings[@]}" >said 2>&1; } 2>seconds || { cat said >&2; exit 1; }
  unseen=$(cairn evaluate out --truth all.h5 --json | "$here/error_reduction.py" 2) # f soft: the mean over f, not a draw
  cairn report out --force >/dev/null
  trained=$(grep -oE '<b>[0-9.]+%</b><span>error reduction, runs trained on' out/report.html | grep -oE '[0-9.]+' | head -n 1 || true)
  trained=$(figure "what the report says of the runs trained on" "$trained")
  seconds=$(figure "processor time" "$(awk '{print $1 + $2}' seconds)")
  printf '%-34s %7d %9.1f%% %9.1f%% %8.1f\n' "$name" "$steps" "$trained" "$unseen" "$seconds"
}

way 'gradient descent (44)' 3000 method=gradient
way 'momentum' 3000 method=momentum
way 'Adam' 3000 method=adam
way 'Adam, batches of 512 true positions' 6000 method=adam batch=512
way 'Adam, networks one after another' 3000 method=adam sequential=true
way 'Adam, cells of 0.25 m' 3000 method=adam cell_m=0.25
way 'conjugate gradient' 500 method=conjugate
way 'pseudo-patterns (45), 100 each' 40 method=pseudo
