#!/usr/bin/env bash
# What a second worker gains on BaLL's gradient: seconds a step with one and with two workers, of real jobs on
# samples of 164 inputs along a corridor. A step's time is the difference of two jobs of different length, so that
# reading the samples and the error before sensing do not count.
#
#   tests/bench/ball_workers.sh [SAMPLES [WINDOW_M [LENGTH_M [STEPS]]]]     # 20000 0 89 8: globally uncertain
set -euo pipefail
cd "$(dirname "$0")/../.."
samples=${1:-20000} window=${2:-0} length=${3:-89} steps=${4:-8}
cairn=build/release/bin/cairn
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

awk -v samples="$samples" -v length_m="$length" 'BEGIN {
  srand(7)
  printf "time_s,x_m,y_m"
  for (i = 0; i < 164; ++i) printf ",i%d", i
  print ""
  for (k = 0; k < samples; ++k) {
    printf "%d,%.4f,%.4f", k, length_m * (k + rand()) / samples, 0.4 * rand()
    for (i = 0; i < 164; ++i) printf ",%.2f", rand()
    print ""
  }
}' > "$folder/run.csv"
"$cairn" import vectors "$folder/run.csv" "$folder/samples.h5" > /dev/null

seconds() {  # STEPS WORKERS
  local begin=$EPOCHREALTIME
  "$cairn" run landmark_learning "$folder/samples.h5" --set window_m="$window" --set sum=pairs --set steps="$1" \
    --out "$folder/out" --force --workers "$2" > "$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
  awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { print b - a }'
}

least() { printf '%s\n' "$@" | sort -g | head -1; }

declare -A short long step
for turn in 1 2 3; do  # the quickest of three: the machine may have other work
  for workers in 1 2; do
    few_s=$(seconds 2 "$workers") # not in an argument, in which a failure would be lost
    many_s=$(seconds $((2 + steps)) "$workers")
    short[$workers]=$(least ${short[$workers]:-} "$few_s")
    long[$workers]=$(least ${long[$workers]:-} "$many_s")
  done
done
for workers in 1 2; do
  step[$workers]=$(awk -v a="${short[$workers]}" -v b="${long[$workers]}" -v n="$steps" 'BEGIN { printf "%.4f", (b - a) / n }')
  echo "$samples samples, window $window m of $length m, $workers worker(s): ${step[$workers]} s a step"
done
awk -v one="${step[1]}" -v two="${step[2]}" 'BEGIN { printf "two workers against one: %.2f\n", one / two }'
