#!/usr/bin/env bash
# What `cairn run --dry-run` expects against what the run then takes: seconds of all workers' processor time, and the
# largest resident set of its only worker. estimates.sh [NAME LOG.h5 KEY=VALUE…]: that job, else some of its own (three
# where CAIRN_DATA names a folder that holds mrclam6 and victoria-park). CAIRN_BIN: the folder of the programs.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/../studies/common.sh"
PATH=${CAIRN_BIN:-$(cd "$(dirname "$0")/../.." && pwd)/build/release/bin}:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

expected() {  # KEY: of plan.json
  figure "the plan's $1" "$(tr -d ' \n' <plan.json | grep -oE '"expected":\{[^}]*\}' | grep -oE "\"$1\":[0-9.eE+-]+" | cut -d: -f2)"
}

# measure NAME LOG KEY=VALUE…
measure() {
  local name=$1 log=$2 settings=()
  shift 2
  for pair in "$@"; do settings+=(--set "$pair"); done
  cairn run landmark_map "$log" "${settings[@]}" --dry-run --json >plan.json
  cairn run landmark_map "$log" "${settings[@]}" --workers 1 --out "$name" >/dev/null 2>&1 &
  local run=$! worker ticks=0 resident=0 store=0 now seconds memory_mb store_mb
  while kill -0 "$run" 2>/dev/null; do  # the worker is gone with the run, so look at it often
    worker=$(pgrep -P "$run" -f cairn-worker | head -n 1 || true)  # not a child that reads a file
    [ -n "$worker" ] || continue
    now=$(awk '/^VmHWM/ {print $2}' "/proc/$worker/status" 2>/dev/null || true)
    [ "${now:-0}" -le "$resident" ] || resident=$now
    now=$(awk '{print $14 + $15}' "/proc/$worker/stat" 2>/dev/null || true)
    [ "${now:-0}" -le "$ticks" ] || ticks=$now
    now=$(du -sk "$name/.cairn" 2>/dev/null | cut -f 1 || true)
    [ "${now:-0}" -le "$store" ] || store=$now
  done
  wait "$run"
  seconds=$(expected seconds) memory_mb=$(expected memory_mb) store_mb=$(expected store_mb)
  awk -v name="$name" -v s="$seconds" -v m="$memory_mb" -v t="$ticks" -v hz="$(getconf CLK_TCK)" \
    -v r="$resident" -v d="$store" -v e="$store_mb" 'BEGIN {
    cpu = t / hz; mb = r * 1.024e-3; disk = d * 1.024e-3
    printf "%-16s seconds: expected %6.2f, used %6.2f (x%.2f)   MB: expected %5.0f, used %5.0f (x%.2f)   ",
      name, s, cpu, cpu / s, m, mb, mb / m
    printf "store MB: expected %5.0f, used %5.0f\n", e, disk }'
}

if [ $# -gt 0 ]; then
  measure "$@"
  exit
fi
cairn simulate loop --difficulty base --robots 4 --seed 1 four.h5 >/dev/null
cairn simulate loop --difficulty base --seed 1 one.h5 >/dev/null
measure base-1m one.h5 cell_m=1
measure base-four four.h5
for r in {1..300}; do printf '%s\n' "0,r$r,0.1,1" "1,r$r,0.1,1" "2,r$r,0.1,1" "3,r$r,0.1,1"; done |
  cat <(echo time_s,robot,turn_rad,forward_m) - >odometry.csv
for r in {1..300}; do printf '%s\n' "2,r$r,$r,1,0" "3,r$r,,,"; done |
  cat <(echo time_s,robot,landmark,range_m,bearing_rad) - >observations.csv
cairn import csv --odometry odometry.csv --observations observations.csv many.h5 >/dev/null
measure 300-robots many.h5
few() { { head -n 1 "$1.csv"; grep -E '^[0-9],r[1-5],' "$1.csv"; } | sed -E "s/,0\.1,1$/,0.3,1/" >"few_$1.csv"; }
few odometry
few observations
cairn import csv --odometry few_odometry.csv --observations few_observations.csv turning.h5 >/dev/null
measure turning-robots turning.h5
for seed in 101 102; do
  cairn simulate loop --difficulty museum --seed "$seed" "museum-$seed.h5" >/dev/null
  measure "museum-$seed" "museum-$seed.h5"
done
for difficulty in base hard extreme; do
  cairn simulate loop --difficulty "$difficulty" --seed 102 "$difficulty-102.h5" >/dev/null
  measure "$difficulty-once" "$difficulty-102.h5" incremental=true
done
measure base-0.25m-2deg one.h5 cell_m=0.25 heading_deg=2 starts=1
if [ -n "${CAIRN_DATA:-}" ]; then
  cairn import mrclam "$CAIRN_DATA/mrclam6" mrclam6.h5 >/dev/null
  measure mrclam-6 mrclam6.h5
  cairn import victoria-park "$CAIRN_DATA/victoria-park" park.h5 >/dev/null 2>&1
  measure victoria-park park.h5
  measure park-5m-once park.h5 cell_m=5 iterations=0
fi
