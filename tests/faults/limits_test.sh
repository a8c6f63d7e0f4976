#!/usr/bin/env bash
# Limits of the system that are too low for a program are said at its start, with exit code 2; just above them it works.
source "$(dirname "$0")/../end_to_end/common.sh"

simulate log.h5
limited() { (ulimit "$1" "$2" && shift 2 && exec timeout 400 "$@"); }
endpoint=ipc://$work/none/hub

for files in 16 24 32; do
  refuses "lets this process open $files files at a time.*ulimit -n" limited -n "$files" cairn run landmark_map log.h5 --out a
  refuses "lets this process open $files files at a time.*ulimit -n" limited -n "$files" cairn coordinator
done
for command in "cairn worker" "cairn list" "cairn inspect log.h5"; do
  # shellcheck disable=SC2086
  refuses 'lets this process open 16 files at a time' limited -n 16 $command
done
exits 2 limited -n 16 cairn-worker --connect "$endpoint"
says 'lets this process open 16 files at a time'

refuses 'lets a file of this process grow to 8 KiB.*ulimit -f' limited -f 8 cairn run landmark_map log.h5 --out a
refuses 'lets a file of this process grow to 8 KiB.*ulimit -f' limited -f 8 cairn coordinator
refuses 'gives this process memory up to 250 MiB.*ulimit -v' limited -v 256000 cairn coordinator
for command in "cairn run landmark_map log.h5 --out a" "cairn inspect log.h5" "cairn coordinator" "cairn list"; do
  # shellcheck disable=SC2086
  refuses 'threads grow to 64 KiB here, and it needs 1 MiB.*ulimit -s' limited -s 64 $command
done
exits 2 limited -s 64 cairn-worker --connect "$endpoint"
says 'threads grow to 64 KiB here'
exits 1 limited -f 8 cairn simulate loop long.h5 --seed 1
says 'no file may grow so large here \(ulimit -f\)'
mkdir pictures
exits 1 limited -f 8 cairn simulate corridor --runs 1 --snapshots 80 --length-m 40 --pictures pictures samples.h5
says 'pictures/d1 run 1.png: cannot write: no file may grow so large here \(ulimit -f\)'
[ -z "$(ls -A pictures)" ] || die "a half-written picture is left: $(ls -A pictures)"
[ ! -e a ] || die "a run that was refused left a folder"

exits 0 limited -n 60 cairn run landmark_map log.h5 --workers 2 --set iterations=1 --out b
exits 0 limited -f 65536 cairn run landmark_map log.h5 --workers 1 --set iterations=1 --out c
same_bits b/landmark_map.h5 c/landmark_map.h5
