#!/usr/bin/env bash
# The chain: landmark_map gives the poses by which sonar becomes maps, in one job; they are better than odometry's. And what
# the documentation says of the hallway's door.
source "$(dirname "$0")/common.sh"

cairn simulate loop --difficulty paper --sonar --seed 7 loop.h5 >/dev/null
printf '%s\n' 'name: chain' 'seed: 7' 'inputs: {log: loop.h5}' 'stages:' \
  '  - {name: landmarks, pipeline: landmark_map, log: log}' \
  '  - {name: raw, pipeline: evidence_map, log: log, options: {cell_m: 0.5}}' \
  '  - {name: evidence, pipeline: evidence_map, log: log, poses: landmarks, options: {cell_m: 0.5}}' \
  '  - {name: forward, pipeline: forward_map, log: log, poses: landmarks, options: {cell_m: 0.5}}' >chain.yaml
exits 0 cairn run chain.yaml --out chain --workers 2

# measure MAP NAME
measure() {
  cairn evaluate "chain/$1.h5" --truth loop.h5 --json >score.json || die "evaluate fails on $1"
  number "$2" score.json
}
awk -v raw="$(measure raw pose_rmse_m)" -v map="$(measure forward pose_rmse_m)" 'BEGIN {exit !(map < 1 && raw > 2 * map)}' ||
  die "the forward map's poses are not landmark_map's: $(cat score.json)"
[ "$(measure evidence pose_rmse_m)" = "$(measure forward pose_rmse_m)" ] || die "both maps have the same poses"
for map in evidence forward; do
  awk -v due="$(measure $map due)" -v missed="$(measure $map missed_occupied)" 'BEGIN {exit !(due > 500 && missed < due / 2)}' ||
    die "$map misses half of the walls: $(cat score.json)"
done
exits 0 cairn report chain/forward.h5 --log loop.h5 --out forward.html
grep -q "<image" forward.html || die "the page shows no map"

for closed in '' --closed; do
  cairn simulate hallway --door-readings 1 $closed --seed 102 --force hallway.h5 >/dev/null
  exits 0 cairn run forward_map hallway.h5 --out hallway --force
  cairn evaluate hallway --truth hallway.h5 --json >score.json || die "evaluate fails on the hallway"
  grep -q "\"open\": $([ -z "$closed" ] && echo true || echo false)" score.json || die "door wrong $closed: $(cat score.json)"
done
exits 0 cairn evaluate hallway --truth hallway  # another map is the truth, by its folder
mkdir nothing
refuses "there is none of log, samples, grid_map in" cairn evaluate hallway --truth nothing
