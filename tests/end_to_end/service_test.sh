#!/usr/bin/env bash
# A coordinator, two workers and clients over ipc: submit, list, status, watch, results, cancel, a restart in between.
source "$(dirname "$0")/common.sh"

simulate log.h5
printf '%s\n' 'name: tour' 'seed: 7' 'inputs: {log: log.h5}' 'stages:' \
  '  - {name: landmark_map, pipeline: landmark_map, log: log}' >job.yaml
exits 0 cairn run job.yaml --out here --workers 2

serve() {
  cairn coordinator >coordinator.log 2>&1 &
  coordinator=$!
}
serve
until_true 20 cairn list >/dev/null
# Another one, on another store, does not take its address away, which its clients would not notice.
refuses "ipc://.*/coordinator.ipc is served by another coordinator: process $coordinator, store .*home/store; stop it" \
  cairn coordinator --store another
exits 0 cairn submit landmark_map log.h5 --seed 99 --json
early=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
exits 0 cairn status "$early"
says "^waiting: no worker is connected \(start 'cairn worker'\)"
exits 0 cairn cancel "$early"
says 'is cancelled$'
refuses "job $early was cancelled before a stage of it was done: it has no results, and will have none" \
  cairn results "$early" --out never
refuses "job $early was cancelled: it shows nothing any more" cairn results "$early" --so-far --out never
refuses "'home/store' is a coordinator's store" cairn inspect home/store
# What the pipeline refuses is not sent away to hear it.
refuses "the start of stage 'evidence_map': the log has no range scans" cairn submit evidence_map log.h5
workers=()
for _ in 1 2; do
  cairn worker >>worker.log 2>&1 &
  workers+=($!)
done

exits 0 cairn submit job.yaml --json
id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
[ -n "$id" ] || die "submit does not say the job's id"
exits 0 cairn list
says "$id"
exits 0 cairn status "$id" --json
says '"state"'

# The coordinator is killed and started again; workers and the job go on, though nobody reads its log but its first line.
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true
cairn coordinator > >(head -n 1 >/dev/null) 2>&1 &
coordinator=$!
exits 0 cairn watch "$id"
exits 0 cairn status "$id"
says 'done'
exits 0 cairn results "$id" --out there
same_bits here there

# A second job is paused over a restart, resumed, and deleted when it is done; one that is not there is named.
kill -9 "${workers[@]}"
sed -i "s|seed: 7|seed: 8|" job.yaml
exits 0 cairn submit job.yaml --json
second=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
exits 0 cairn pause "$second"
says "^$second is paused: paused by its owner"
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true
serve
exits 0 cairn status "$second"
says '^state +paused'
exits 0 cairn priority "$second" 3
refuses 'has not ended; cancel it first' cairn delete "$second"
exits 0 cairn resume "$second"
cairn worker >>worker.log 2>&1 &
exits 0 cairn watch "$second"
refuses 'it is done' cairn pause "$second"
refuses 'it was cancelled' cairn resume "$early"
exits 0 cairn delete "$early" "$id"
says "^$early is deleted"
[ ! -e home/store/results/"$id" ] || die "a deleted job's results are still there"
refuses "nobody'; known: .*$second" cairn status nobody

# What there is to see of a job takes the place of what there was of that job, of another's none.
for seed in 1 2; do
  exits 0 cairn submit landmark_map log.h5 --set starts=100 --set iterations=10000 --seed "$seed" --json
  shown=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
  until_true 60 cairn results "$shown" --so-far --out "so_far_$seed" >/dev/null 2>&1
  exits 0 cairn results "$shown" --so-far --out "so_far_$seed"
  if [ "$seed" -eq 2 ]; then
    refuses "landmark_map-so-far.h5' is there already, and is not this result" cairn results "$shown" --so-far --out so_far_1
    rm so_far_1/landmark_map-so-far.h5
    refuses "so_far_1/.*' is there already, and is of another job" cairn results "$shown" --so-far --out so_far_1
    exits 0 cairn results "$shown" --so-far --out so_far_1 --force
  fi
  exits 0 cairn cancel "$shown"
done

# A job for each log of a fleet, all with what the command line says; their results each in a folder of its own.
mkdir logs logs/not-a-log.h5
cp log.h5 logs/monday.h5
simulate logs/tuesday.h5 9
refuses "no file matches 'nowhere/" cairn submit landmark_map --each 'nowhere/*.h5'
refuses 'log.h5. is one too many' cairn submit landmark_map log.h5 --each 'logs/*.h5'
printf 'no log' >logs/zuletzt.h5
refuses 'nothing is submitted, for 1 of 3 files cannot be: .*zuletzt.h5' cairn submit landmark_map --each 'logs/*.h5'
rm logs/zuletzt.h5
exits 0 cairn list --name 'landmark_map-*'
! grep -q landmark_map-monday stdout || die "some of the jobs were submitted, though one file is none"
exits 0 cairn submit landmark_map --each 'logs/*.h5' --priority -2
[ "$(grep -c '^submitted ' stdout)" -eq 2 ] || die "not one job for each of the two logs"
read -r monday tuesday < <(awk '{sub(/;/, "", $2); printf "%s ", $2}' stdout) || true
for job in "$monday" "$tuesday"; do
  exits 0 cairn watch "$job"
  says '^priority -2'
done
exits 0 cairn submit landmark_map --each 'logs/*.h5' --priority -2
says "^already there: $monday, done; cairn watch $monday"
says "^already there: $tuesday, done; "
exits 0 cairn list --name 'landmark_map-*' --state done
says "^$monday .*landmark_map-monday"
says "^$tuesday .*landmark_map-tuesday"
[ "$(grep -c ' done ' stdout)" -eq 2 ] || die "list shows more than was asked for"
exits 0 cairn list --state running
[ "$(grep -c "$monday" stdout)" -eq 0 ] || die "list --state running shows what is done"
refuses 'state' cairn list --state asleep
exits 0 cairn results "$monday" "$tuesday" --out both
exits 0 cairn results --name 'landmark_map-*' --out named
for job in "$monday" "$tuesday"; do same_bits both/"$job" named/"$job"; done
exits 0 cairn run landmark_map logs/tuesday.h5 --out tuesday
same_bits tuesday both/"$tuesday"
# Two at once into one folder: the second finds the first one's.
for i in 1 2 3 4; do
  cairn results "$monday" --out "at_once_$i" >/dev/null 2>&1 & first=$!
  cairn results "$tuesday" --out "at_once_$i" >/dev/null 2>&1 & second=$!
  codes=0
  wait "$first" || codes=$((codes + $?))
  wait "$second" || codes=$((codes + $?))
  [ "$codes" -eq 2 ] || die "both ended alike, or with another code than 2: $codes in all"
done
refuses "no job that is done is called 'nobody'" cairn results --name nobody
refuses 'name the jobs' cairn results
grep -q 'listening on' coordinator.log || die "the coordinator does not say where it listens"
kill -STOP "$coordinator"
exits 1 cairn results "$monday" --out late
grep -qE 'does not answer|no service listens' stderr || die "no word on a service that stands still: $(cat stderr)"
kill -CONT "$coordinator"
# By a pattern: those alone that can do it.
refuses 'name the jobs by their ids, or say --name' cairn delete
refuses 'there is no such job, or none that you can cancel' cairn cancel --name 'landmark_map-*'
exits 0 cairn delete --name 'landmark_map-*' --state done
says "^$monday is deleted"
says "^$tuesday is deleted"
[ "$(grep -c 'is deleted' stdout)" -eq 2 ] || die "others are deleted, too"
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"

# Of a chain whose second result is damaged the first comes all the same; the exit code says that it is not all.
(CAIRN_HOME=$work/damaged exec cairn coordinator) 2>damaged.log &
coordinator=$!
export CAIRN_HOME=$work/damaged
until_true 10 grep -q 'listening on' damaged.log
printf '%s\n' 'name: chain' 'inputs: {log: log.h5}' 'stages:' \
  '  - {name: first, pipeline: landmark_map, log: log, options: {iterations: 1}}' \
  '  - {name: second, pipeline: landmark_map, log: log, options: {iterations: 2}}' >chain.yaml
exits 0 cairn submit chain.yaml
cairn worker >>worker.log 2>&1 &
exits 0 cairn watch 1-chain
printf 'XXXXXXX' | dd of=damaged/store/results/1-chain/second.h5 bs=1 seek=5000 conv=notrunc status=none
refuses "what can be read is in 'part'; it lacks the stage 'second': .*damaged" cairn results 1-chain --out part
exits 0 cairn inspect part/first.h5
[ ! -e part/second.h5 ] || die "a damaged result was fetched"
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"

# A store that is moved away takes nothing in any more, for nobody would find it; back in its place it does.
(CAIRN_HOME=$work/moving exec cairn coordinator) 2>moving.log &
coordinator=$!
export CAIRN_HOME=$work/moving
until_true 10 grep -q 'listening on' moving.log
exits 0 cairn submit landmark_map log.h5 --seed 1
mv moving/store moved
for _ in 1 2; do
  exits 1 cairn submit landmark_map log.h5 --seed 2
  says '^cairn: .*the store was moved or removed.*the job was not taken'
done
[ ! -e moving/store ] || die "it made its store anew: $(find moving/store)"
mv moved moving/store
exits 0 cairn submit landmark_map log.h5 --seed 2
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"
export CAIRN_HOME=$work/home

# A store of a newer Cairn, and one from before files had checksum trailers, are refused with the reason and left as they are.
echo 1000 >home/store/version
refuses 'a store of version 1000, of a newer Cairn' cairn coordinator
cp -r "$CAIRN_SOURCE/coordinator/store/testdata/store_1/store" no_trailer
refuses 'its files have no checksum trailers' cairn coordinator --store no_trailer
diff -r --exclude lock "$CAIRN_SOURCE/coordinator/store/testdata/store_1/store" no_trailer || die "a refused store was touched"
