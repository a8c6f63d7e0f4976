#!/usr/bin/env bash
# Large logs go up in pieces: what coordinator and clients have in memory does not grow with them, one at a time or three;
# and an upload that is cut off, by whichever side, leaves nothing and begins again.
source "$(dirname "$0")/common.sh"
large_log=${CAIRN_BUILD:?}/tests/end_to_end/large_log
most_mb=100 # of memory, of each process; the logs have 105 and more
for i in 1 2 3; do "$large_log" large$i.h5 $((100 + 5 * i)) "$i"; done

serve() {
  cairn coordinator >>coordinator.log 2>&1 &
  coordinator=$!
  until_true 20 cairn list >/dev/null
}
# peak_mb PID: into `mb`; false where it is gone.
peak_mb() {
  local key kb
  while read -r key kb _; do
    [ "$key" = VmHWM: ] && mb=$((kb / 1024)) && return
  done 2>/dev/null <"/proc/$1/status"
  return 1
}
# submit FILE: in the background.
submit() {
  cairn submit landmark_map "$1" >"$1.out" 2>&1 &
  client=$!
}
# watch_memory PID NAME: until it ends.
watch_memory() {
  while peak_mb "$1" 2>/dev/null; do
    printf '%s\n' "$mb" >"$2.mb"
    sleep 0.2
  done
}
half() { compgen -G 'home/store/uploads/*.part' >/dev/null; }
nothing_half() { ! half; }
# Waits for an upload to begin, more often than it could end in between.
in_the_middle() {
  local tries=10000
  until half; do
    ((tries-- > 0)) || die "no upload began: $(cat ./*.out)"
    sleep 0.01
  done
  kill -STOP "$client"
  half || die "the upload was over too soon"
}

serve
submit large1.h5
watch_memory "$client" alone
wait "$client" || die "the log was not taken: $(cat large1.h5.out)"
grep -q '^submitted 1-' large1.h5.out || die "$(cat large1.h5.out)"
peak_mb "$coordinator"
printf 'alone: client %s MB, coordinator %s MB\n' "$(cat alone.mb)" "$mb"
below "$(cat alone.mb)" "$most_mb"
below "$mb" "$most_mb"

# What is there is not sent again, but for another job.
exits 0 cairn submit landmark_map large1.h5
says '^already there: 1-'
exits 0 cairn submit landmark_map large1.h5 --seed 9
says '^submitted 2-'
[ "$(find home/store/blobs -name '*.flat' | wc -l)" -eq 1 ] || die "one log has two files"

# Three at once, into an empty store.
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"
rm -rf home/store
serve
pids=()
for i in 1 2 3; do
  submit large$i.h5
  pids+=("$client")
  watch_memory "$client" "three$i" &
done
for pid in "${pids[@]}"; do wait "$pid" || die "not all three were taken: $(cat ./*.out)"; done
peak_mb "$coordinator"
printf 'three at once: clients %s %s %s MB, coordinator %s MB\n' "$(cat three1.mb)" "$(cat three2.mb)" \
  "$(cat three3.mb)" "$mb"
for i in 1 2 3; do below "$(cat three$i.mb)" "$most_mb"; done
below "$mb" "$most_mb"
[ "$(find home/store/blobs -name '*.flat' | wc -l)" -eq 3 ] || die "not three logs in the store"
nothing_half || die "something half is left"

# A client that is killed leaves nothing.
"$large_log" other.h5 105 4
submit other.h5
in_the_middle
kill -9 "$client"
wait "$client" 2>/dev/null || true
until_true 10 nothing_half
[ "$(find home/store/blobs -name '*.flat' | wc -l)" -eq 3 ] || die "a log without a job is in the store"

# A coordinator that is killed leaves half a file, which its next start removes; the client begins again by itself.
submit other.h5
in_the_middle
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true
half || die "a killed coordinator left no half upload: it is not the middle"
cairn coordinator >>coordinator.log 2>&1 &
coordinator=$!
until_true 20 nothing_half
kill -CONT "$client"
wait "$client" || die "the client did not begin again: $(cat other.h5.out)"
grep -q '^submitted ' other.h5.out || die "$(cat other.h5.out)"

# All of them are whole: a start reads every input.
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"
serve
exits 0 cairn list --state queued
[ "$(grep -c queued stdout)" -eq 4 ] || die "not all jobs came back: $(cat stdout)"
! grep -q 'quarantined' coordinator.log || die "an input is damaged: $(cat coordinator.log)"
