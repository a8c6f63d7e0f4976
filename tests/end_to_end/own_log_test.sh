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

# A robot that turns while it goes, and wheels that are read twice a second: the mapping asks, the import has an option, and
# who insists at the import is not asked again.
awk 'BEGIN {
  OFS = ","; h = 0.01
  for (k = 0; k < 12; k++) {x[k] = 7 * cos(k * 2.4); y[k] = 7 * sin(k * 2.4)}
  print "time_s", "turn_rad", "forward_m" >"wheels.csv"
  print "time_s", "landmark", "range_m", "bearing_rad" >"poles.csv"
  for (i = 0; i <= 6000; i++) {
    if (i > 0) {w = 0.35 + 0.3 * sin(i * h / 3); d += w * h; px += 0.8 * h * cos(d); py += 0.8 * h * sin(d)}
    if (i % 50) continue
    print i * h, d - before, i ? 0.4 : 0 >"wheels.csv"
    before = d
    for (k = 0; k < 12; k++) {
      b = atan2(y[k] - py, x[k] - px) - d; b = atan2(sin(b), cos(b))
      if (b < 1.5 && b > -1.5) print i * h, "pole" k, sqrt((x[k] - px) ^ 2 + (y[k] - py) ^ 2), b >"poles.csv"
    }
  }
}'
import_wheels() { exits 0 cairn import csv --odometry wheels.csv --observations poles.csv --force wheels.h5 "$@"; }
import_wheels
refuses 'turned along the way rather than before it.*--steps-are-arcs' cairn run landmark_map wheels.h5 --dry-run
import_wheels --units-are-right
exits 0 cairn run landmark_map wheels.h5 --dry-run
exits 0 cairn map wheels.h5 --out insisted
grep -q 'half of such a step is 0.20 m.*--steps-are-arcs. takes that off' stdout || die "the verdict says nothing of half a step"
! grep -q 'sensor-mount' stdout || die "the verdict moves a sensor for half a step"
import_wheels --steps-are-arcs
exits 0 cairn map wheels.h5 --out arcs
grep -q '^verdict *high' stdout || die "the map of arcs is not to be trusted"
exits 0 cairn inspect wheels.h5
! grep -q 'in doubt' stdout || die "arcs that were named are in doubt"
