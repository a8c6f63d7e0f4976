#!/usr/bin/env bash
# What a new user does, in order: simulate, look, run, evaluate, export, report, compare, run again.
source "$(dirname "$0")/common.sh"

exits 0 cairn simulate loop --difficulty paper --seed 7 log.h5
exits 0 cairn inspect log.h5
says 'log'
exits 0 cairn run landmark_map log.h5 --dry-run
says 'cell_m'
says 'expected: planned: .* million cells'
exits 0 cairn run landmark_map log.h5 --dry-run --json
for figure in cells tasks rounds seconds task_mb memory_mb store_mb; do says "\"$figure\": [0-9.]+"; done
[ ! -e landmark_map ] || die "a dry run left something behind"
exits 0 cairn run landmark_map log.h5 --out 'my result' --workers 2
says 'report.html'
says 'landmarks'
for file in landmark_map.h5 map.png report.html; do
  [ -s "my result/$file" ] || die "there is no $file"
done
head -c 8 'my result/map.png' | grep -q PNG || die "map.png is no PNG"
grep -q '</html>' 'my result/report.html' || die "report.html is cut off"
! grep -Eqi '(src|href)="(https?:)?//' 'my result/report.html' || die "report.html needs the network"

exits 0 cairn inspect 'my result/landmark_map.h5' --json
exits 0 cairn evaluate 'my result' --truth log.h5 --json
for key in found missed spurious within_3m rmse_m rmse_similarity_m gospa_m correct iterations seconds; do
  [ -n "$(number $key stdout)" ] || die "evaluate does not print $key"
done
[ "$(number found stdout)" -gt 0 ] || die "no landmark was found"

for format in tum g2o ros png csv; do
  exits 0 cairn export $format 'my result' exported
done
exits 0 cairn export csv log.h5 csv
for file in graph.g2o map.pgm map.yaml map.png poses.csv landmarks.csv; do
  [ -s "exported/$file" ] || die "export made no $file"
done
ls exported/*.tum >/dev/null || die "export made no trajectory"
exits 0 cairn report 'my result' --log log.h5 --out again.html
grep -q '</html>' again.html || die "the page is cut off"
refuses 'there already' cairn report 'my result' --out again.html
refuses 'there already' cairn report 'my result'
exits 0 cairn report 'my result' --force
exits 0 cairn export csv log.h5 csv  # the same again
echo >>csv/odometry.csv
refuses "csv/odometry.csv' is there already" cairn export csv log.h5 csv
exits 0 cairn export csv log.h5 csv --force

# The same again: finished, says so, and touches no result.
before=$(stat -c '%i %Y' 'my result/landmark_map.h5')
exits 0 cairn run landmark_map log.h5 --out 'my result' --workers 1
says 'finished'
[ "$before" = "$(stat -c '%i %Y' 'my result/landmark_map.h5')" ] || die "a finished result was written again"

# Another job in the same folder: refused, then forced.
refuses 'force' cairn run landmark_map log.h5 --set iterations=1 --out 'my result'
refuses 'memory_mb' cairn run landmark_map log.h5 --set memory_mb=1 --out 'my result' --force
[ "$before" = "$(stat -c '%i %Y' 'my result/landmark_map.h5')" ] || die "a run that was refused replaced a result"
[ -s 'my result/map.png' ] || die "a run that was refused took the picture away"
exits 0 cairn diff 'my result' 'my result'
exits 0 cairn run landmark_map log.h5 --set iterations=1 --out other
exits 1 cairn diff 'my result' other
exits 0 cairn run landmark_map log.h5 --set iterations=1 --out 'my result' --force
same_bits 'my result' other

# What comes out of export csv goes into import csv, and gives the same bits.
exits 0 cairn import csv --odometry csv/odometry.csv --observations csv/observations.csv log2.h5
exits 0 cairn run landmark_map log2.h5 --set iterations=1 --out from_csv
