#!/usr/bin/env bash
# Ctrl-C stops in good order; two runs do not share a folder; a full disk pauses and leaves nothing half-written.
source "$(dirname "$0")/common.sh"

cairn simulate loop --difficulty base --robots 2 --seed 5 log.h5 >/dev/null
cairn run landmark_map log.h5 --out stopped --workers 2 >background.out 2>background.err &
run=$!
until_true 20 pgrep -P "$run" -f cairn-worker >/dev/null
refuses 'stopped' cairn run landmark_map log.h5 --out stopped --workers 2
kill -INT "$run"
code=0
wait "$run" || code=$?
[ "$code" -eq 130 ] || die "Ctrl-C gave exit code $code, not 130"
exits 0 cairn run landmark_map log.h5 --out stopped --workers 2
exits 0 cairn run landmark_map log.h5 --out whole --workers 2
same_bits stopped whole

# A disk of 200 kB: needs the right to mount.
mkdir full
mount -t tmpfs -o size=200k tmpfs full 2>/dev/null || exit 0
code=0
cairn run landmark_map log.h5 --out full/out --workers 2 >stdout 2>stderr || code=$?
left=$(find full -name '*.tmp' | wc -l)
[ ! -e full/out/landmark_map.h5 ] || cairn inspect full/out/landmark_map.h5 >/dev/null || left=1
umount full
[ "$code" -eq 1 ] || die "a full disk gave exit code $code, not 1"
says 'space|full'
[ "$left" -eq 0 ] || die "a half-written file is left on the full disk"

# One with room for bytes, and for no more files.
mount -t tmpfs -o size=20m,nr_inodes=2 tmpfs full
touch full/last
code=0
cairn simulate loop full/loop.h5 >stdout 2>stderr || code=$?
umount full
[ "$code" -eq 1 ] || die "a disk without room for files gave exit code $code, not 1"
says 'full/loop.h5: cannot write: no space left: the disk that holds it has no room for more files'
for inodes in 4 6 8 10; do  # enough for a folder, for another, for …
  mount -t tmpfs -o "size=20m,nr_inodes=$inodes" tmpfs full
  code=0
  cairn run landmark_map log.h5 --out full/out >stdout 2>stderr || code=$?
  umount full
  [ "$code" -eq 1 ] || die "a disk with room for $inodes files gave exit code $code, not 1"
  says 'no room for more files'
done
