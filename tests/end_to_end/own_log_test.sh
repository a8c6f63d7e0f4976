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
for file in my.h5 my-map/landmarks.h5 my-map/map.png my-map/report.html my-map-tables/landmarks.csv my-map-picture/*.png my-with-truth.h5; do
  [ -s "$file" ] || die "the tutorial did not make $file"
done

# The rows that the tutorial shows are good ones: odometry, the same as poses, observations.
awk '/^```csv$/ {on = 1; n++; next} /^```$/ {on = 0} on {print > ("shown" n ".csv")}' "$CAIRN_SOURCE/docs/my-own-log.md"
exits 0 cairn import csv --odometry shown1.csv --observations shown3.csv shown.h5
cut -d, -f1,3- shown3.csv >one-robot.csv
exits 0 cairn import csv --odometry shown2.csv --observations one-robot.csv shown-poses.h5

# The mistake of units that it shows, the words of the message too, and how to insist.
sed '2s/.*/0.20,anna,door,3.2,179.3/;3d' shown3.csv >degrees.csv
refuses 'bearings reach 179.3: are they in degrees. Cairn reads radians' \
  cairn import csv --odometry shown1.csv --observations degrees.csv degrees.h5
said=$(grep -o 'bearings reach 179.3.*' stderr)
grep -qF "$said" "$CAIRN_SOURCE/docs/my-own-log.md" || die "the tutorial shows another message than: $said"
[ ! -e degrees.h5 ] || die "a log that was refused was written"
exits 0 cairn import csv --units-are-right --odometry shown1.csv --observations degrees.csv degrees.h5
sed '1s/bearing_rad/bearing_deg/' degrees.csv >said.csv
exits 0 cairn import csv --odometry shown1.csv --observations said.csv said.h5

# A hole in the odometry is said where the log is made, and where a map is made of it.
awk -F, 'NR == 1 || $1 < 60 || $1 > 100' odometry.csv >hole.csv
exits 0 cairn import csv --odometry hole.csv --observations observations.csv hole.h5
says "^cairn: warning: robot 'robot 0': its odometry lacks 40.* s from .* some [0-9]+ m are missing"
exits 0 cairn run landmark_map hole.h5 --dry-run
says "^cairn: warning: hole.h5: robot 'robot 0': its odometry lacks 40"
