#!/usr/bin/env bash
# How far the errors of the position labels bound what BaLL learns: simulated corridors whose labels are 0.1 m and
# 0.3 m off, 1, 2 and 4 networks for +-2 m; three runs trained on, a fourth that nothing saw.
#   tests/studies/ball_labels.sh [SEED]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
PATH=$PWD/build/release/bin:$PATH
seed=${1:-101}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
recipe=(--set window_m=2 --set steps=500 --set rate=0.02 --set weight_decay=0.01 --set input_noise=0.5
  --set init_width=0.5 --workers 1)
for set in d3 d1; do
  for error_m in 0.1 0.3; do
    log=$dir/$set-$error_m
    cairn simulate corridor --set $set --seed "$seed" --runs 3 --label-error-m $error_m "$log.train.h5" >/dev/null
    cairn simulate corridor --set $set --seed "$seed" --label-error-m $error_m "$log.all.h5" >/dev/null
    for networks in 1 2 4; do
      cairn run landmark_learning "$log.train.h5" --set networks=$networks "${recipe[@]}" \
        --out "$log.$networks" >/dev/null 2>&1
      printf '%s, labels %s m off, n = %s: ' $set $error_m $networks
      cairn evaluate "$log.$networks" --truth "$log.all.h5" | awk '$1 == "+-2" && $2 == "m" {print $7, $8, $9}'
    done
  done
done
