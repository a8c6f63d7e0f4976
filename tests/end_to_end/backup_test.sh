#!/usr/bin/env bash
# A store is copied while it is served, the original is lost, and another goes on from the copy: the same bits. Then copies
# over copies, a full disk, damage, and places where no store may go.
source "$(dirname "$0")/common.sh"

simulate log.h5
job() { # NAME: another job each
  printf '%s\n' "name: $1" 'inputs: {log: log.h5}' 'stages:' \
    '  - {name: landmark_map, pipeline: landmark_map, log: log, options: {cell_m: 0.3}}' >"$1.yaml"
  exits 0 cairn submit "$1.yaml" --json
  id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
}
serve() {
  cairn coordinator --checkpoint-rounds 1 >>coordinator.log 2>&1 &
  coordinator=$!
  until_true 20 cairn list >/dev/null
}
refuses 'is no store' cairn backup copy
serve
job early
early=$id
cairn worker >worker.log 2>&1 &
worker=$!
exits 0 cairn watch "$early"
exits 0 cairn results "$early" --out undisturbed
exits 0 cairn backup copy
says '^1 job in copy; copied [0-9]+ files'

# Copied again and again while a job runs: each copy is whole, whatever moment it is of. The last one before the end goes on.
job late
late=$id
round() { number round status.json; }
stands() { cairn status "$late" --json >status.json && [ "$(round)" -ge 1 ]; }
until_true 60 stands
# A round is saved while the next one is computed; the first two checkpoints are of none.
saved() { [ "$(find "home/store/checkpoints/$late" -name '*.h5' -printf '%f\n' | sort -n | tail -n 1 | cut -d. -f1)" -ge 4 ]; }
until_true 60 saved
kill -STOP "$worker" # so that it is not over before it was copied, however slow this machine is
exits 0 cairn backup copy
says '^2 jobs in copy'
cairn backup copy >/dev/null 2>stderr &
copying=$!
kill -CONT "$worker"
wait "$copying" || die "a copy of a job that runs fails: $(cat stderr)"
for _ in 1 2 3 4; do
  kill -STOP "$worker" # nor over before it is copied for the last time
  exits 0 cairn status "$late" --json
  cp stdout status.json
  grep -q running stdout || break
  exits 0 cairn backup copy
  says '^2 jobs in copy'
  [ "$(round)" -lt 12 ] || break
  kill -CONT "$worker"
done
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true
kill -CONT "$worker"
rm -r home/store
exits 0 cairn restore copy
says "^2 jobs in .*home/store"
serve
exits 0 cairn status "$late" --json
cp stdout status.json
[ "$(round)" -gt 0 ] || die "it begins anew: the copy had none of its rounds"
exits 0 cairn watch "$late"
exits 0 cairn results "$late" --out there
same_bits undisturbed there
exits 0 cairn results "$early" --out again
same_bits undisturbed again
exits 0 cairn logs "$early"
says 'submitted'
job third
[[ $id == 3-* ]] || die "a number is used again: $id"

# Deleted there, gone here; over a copy only what is new is copied.
exits 0 cairn watch "$id"
exits 0 cairn delete "$early"
exits 0 cairn backup copy
says '^2 jobs in copy'
[ ! -e "copy/results/$early" ] && [ ! -e "copy/checkpoints/$early" ] || die "a deleted job is in the copy"
exits 0 cairn backup copy --json
[ "$(number files stdout)" -eq 0 ] || die "files are copied twice: $(cat stdout)"

# What is there stays.
refuses 'home/store is there already' cairn restore copy
mkdir mine && touch mine/thesis.tex
refuses "mine is there already, and is no backup" cairn backup mine
refuses "home/store is there already, and is no backup" cairn backup home/store --store copy
refuses 'copy is a backup, and stays one: .cairn restore .*copy --store ANOTHER.' cairn coordinator --store copy

# One byte of the copy changed: a restore says what it does not bring back, and its exit code too.
rm copy/backup-is-whole
refuses 'no backup that was made to its end' cairn restore copy --store back
result=$(ls copy/results/"$late"/*.h5)
printf '\x5a' | dd of="$result" bs=1 seek=2000 conv=notrunc status=none
exits 1 cairn restore copy --store back --unfinished
says "not copied: job $late: $result, as it was copied: .*"
