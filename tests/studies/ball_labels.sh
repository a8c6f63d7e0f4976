#!/usr/bin/env bash
# How far the errors of the position labels bound what BaLL learns: simulated corridors whose labels are 0.1 m and
# 0.3 m off, 1, 2 and 4 networks for +-2 m; three runs trained on, a fourth that nothing saw.
#   tests/studies/ball_labels.sh [SEED [SET...]]     d3 and d1 without a set. STEPS: of training, 500 without it.
#   NETWORKS: how many, one after another, without it "1 2 4"
#   CAIRN_BIN: the folder of the programs
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
PATH=$(realpath "${CAIRN_BIN:-$here/../../build/release/bin}"):$PATH
seed=${1:-101}
sets=("${@:2}")
[ $# -gt 1 ] || sets=(d3 d1)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
recipe=(--set window_m=2 --set steps="${STEPS:-500}" --set rate=0.02 --set weight_decay=0.01 --set input_noise=0.5
  --set init_width=0.5 --workers 1)
for set in "${sets[@]}"; do
  for error_m in 0.1 0.3; do
    log=$dir/$set-$error_m
    cairn simulate corridor --set "$set" --seed "$seed" --runs 3 --label-error-m $error_m "$log.train.h5" >/dev/null
    cairn simulate corridor --set "$set" --seed "$seed" --label-error-m $error_m "$log.all.h5" >/dev/null
    for networks in ${NETWORKS:-1 2 4}; do
      cairn run landmark_learning "$log.train.h5" --set networks=$networks "${recipe[@]}" --out "$log.$networks" \
        >"$dir/said" 2>&1 || { cat "$dir/said" >&2; exit 1; }
      reduction=$(cairn evaluate "$log.$networks" --truth "$log.all.h5" --json | "$here/error_reduction.py" 2)
      echo "$set, labels $error_m m off, n = $networks: $reduction%"
    done
  done
done
