#!/usr/bin/env bash
# Follows docs/my-own-log.md word by word: every command in its ```sh blocks, on CSV files of the kind that it shows.
source "$(dirname "$0")/common.sh"

# The reader's files: here of a simulated robot.
simulate demo.h5
exits 0 cairn export csv demo.h5 .
[ -s odometry.csv ] && [ -s observations.csv ] || die "export csv left no odometry and observations"
rm demo.h5

awk '/^```sh$/ {on = 1; next} /^```$/ {on = 0} on' "$CAIRN_SOURCE/docs/my-own-log.md" >commands
[ "$(wc -l <commands)" -ge 8 ] || die "the tutorial has lost its commands"
while IFS= read -r command; do
  bash -euc "$command" >stdout 2>stderr || die "the tutorial's command failed: $command"
done <commands
for file in my.h5 my-map/landmark_map.h5 my-map/map.png my-map/report.html my-map-tables/landmarks.csv my-map-ros/map.pgm my-with-truth.h5; do
  [ -s "$file" ] || die "the tutorial did not make $file"
done

# The rows that the tutorial shows are good ones.
awk '/^```csv$/ {on = 1; n++; next} /^```$/ {on = 0} on {print > ("shown" n ".csv")}' "$CAIRN_SOURCE/docs/my-own-log.md"
sed -i 's/^0.20,/20.20,/' shown1.csv
exits 0 cairn import csv --odometry shown1.csv --observations shown2.csv shown.h5
