#!/usr/bin/env bash
# One worker, two, three, five: the same bits. So with one that is killed, and with the truth stripped from the log.
source "$(dirname "$0")/common.sh"

cairn simulate loop --difficulty paper --robots 2 --seed 3 log.h5 >/dev/null
map=(cairn run landmark_map --set starts=2 --set waves=0 --set iterations=5)  # a search, but a short one
"${map[@]}" log.h5 --out one --workers 1 2>stderr >stdout || die "one worker"
for workers in 2 3 5; do
  exits 0 "${map[@]}" log.h5 --out "with $workers" --workers "$workers"
  same_bits one "with $workers"
done

# A worker is killed as soon as there is one; the run goes on.
"${map[@]}" log.h5 --out killed --workers 3 >stdout 2>stderr &
run=$!
until_true 20 pgrep -P "$run" -f cairn-worker >/dev/null
kill -9 "$(pgrep -P "$run" -f cairn-worker | head -n 1)" 2>/dev/null || true
wait "$run" || die "the run did not outlive a worker"
same_bits one killed

# The same log without its truth.
exits 0 cairn export csv log.h5 csv
figures=(--heading-drift-rad-per-m 0.002 --heading-walk-rad-per-sqrt-m 0.012 --forward-ratio 0.02 --turn-ratio 0.02)
exits 0 cairn import csv --odometry csv/odometry.csv --observations csv/observations.csv "${figures[@]}" bare.h5
exits 0 cairn import csv --odometry csv/odometry.csv --observations csv/observations.csv "${figures[@]}" \
  --truth-poses csv/truth_poses.csv --truth-landmarks csv/truth_landmarks.csv \
  --truth-associations csv/truth_associations.csv true.h5
exits 1 cairn diff bare.h5 true.h5
exits 0 "${map[@]}" bare.h5 --out bare
exits 0 "${map[@]}" true.h5 --out true
same_bits bare true
