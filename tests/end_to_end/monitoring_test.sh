#!/usr/bin/env bash
# A coordinator is watched over HTTP and by a monitor's plugin while its store is read, while it works and while its disk
# fails; alerts and dashboard speak of metrics that there are; logs are JSON.
source "$(dirname "$0")/common.sh"

# get PATH [PORT]: the answer, its head first, in the file `answer`; fails where nobody listens.
get() {
  (exec 3<>"/dev/tcp/127.0.0.1/${2:-$port}" && printf 'GET %s HTTP/1.1\r\nHost: here\r\n\r\n' "$1" >&3 && cat <&3) \
    >answer 2>/dev/null
}
# answers CODE PATH
answers() { get "$2" && head -n 1 answer | grep -q " $1 "; }
# shows LINE: a line of the metrics, as they are now.
shows() { get /metrics && grep -qx -- "$1" answer; }
serve() {
  rm coordinator.log  # of the one before
  cairn --log-format json coordinator --metrics 0 2>coordinator.log &
  coordinator=$!
  until_true 10 grep -q 'listening on' coordinator.log
  port=$(sed -n 's|.*http://127\.0\.0\.1:\([0-9]*\)/metrics.*|\1|p' coordinator.log)
  until_true 10 answers 200 /healthz
}

# Off unless it is asked for; a port that another has, and what is none, are refused.
cairn coordinator 2>coordinator.log &
coordinator=$!
until_true 10 grep -q 'listening on' coordinator.log
! grep -q metrics coordinator.log || die "it shows metrics unasked"
[ -z "$(find /proc/$coordinator/fd -lname 'socket:*' -printf '%l\n' | tr -dc '0-9\n' | sort >sockets
  awk '$4 == "0A" {print $10}' /proc/net/tcp /proc/net/tcp6 | sort | comm -12 sockets -)" ] || die "it listens over TCP unasked"
exits 0 cairn status --check
says '^CAIRN OK: 0 jobs running, 0 queued, 0 workers \| jobs_running=0 '
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"
exits 2 cairn status --check
says '^CAIRN CRITICAL: .*no service listens'
[ "$(wc -l <stdout)" -eq 1 ] || die "more than a line: $(cat stdout)"
refuses "'nonsense' is no address" cairn coordinator --metrics nonsense
refuses 'excludes' cairn status 1-job --check

serve
answers 200 /readyz || die "it is not ready: $(cat answer)"
answers 404 / || die "it serves what nobody knows: $(cat answer)"
refuses 'in use' cairn coordinator --store another --listen "ipc://$work/home/another" --metrics "$port"
shows 'cairn_jobs{state="queued"} 0' || die "no count of jobs: $(cat answer)"

simulate log.h5
exits 0 cairn submit landmark_map log.h5 --set iterations=2
exits 2 cairn status --check
says '^CAIRN CRITICAL: no worker can take what the jobs wait for; 0 jobs running, 1 queued, 0 workers'
until_true 10 shows 'cairn_jobs{state="queued"} 1'
cairn worker --log-format json 2>worker.log &
exits 0 cairn watch
exits 0 cairn status --check
until_true 10 shows 'cairn_jobs{state="done"} 1'
shows 'cairn_workers{state="idle"} 1' || die "not the worker: $(cat answer)"
for metric in cairn_tasks_done_total cairn_received_bytes_total cairn_sent_bytes_total cairn_store_bytes cairn_checkpoints_total \
  cairn_round_duration_seconds_count cairn_event_loop_turn_seconds_sum cairn_last_checkpoint_timestamp_seconds; do
  below 0 "$(sed -n "s/^$metric //p" answer)"
done
below "$(sed -n 's/^cairn_last_checkpoint_timestamp_seconds //p' answer)" "$(($(date +%s) + 1))"
# Nobody's name is there: not the job's, the file's, the machine's.
! grep -E "landmark|log\.h5|$(hostname)|$work" answer || die "it shows a name"

# What alerts and dashboard speak of.
cut -d' ' -f1 answer | cut -d'{' -f1 | sort -u >there
grep -hE '"?expr"?:|^          ' "$CAIRN_SOURCE"/deploy/monitoring/{rules.yml,dashboard.json} | grep -oE 'cairn_[a-z_]+' | sort -u >spoken
[ "$(wc -l <spoken)" -ge 15 ] || die "alerts and dashboard speak of too little: this test looks at nothing"
[ -z "$(comm -23 spoken there)" ] || die "there is no $(comm -23 spoken there)"
grep -oE 'Cairn[A-Z][A-Za-z]+' "$CAIRN_SOURCE/docs/monitoring.md" | sort -u >alerts
sed -n 's/.*- alert: //p' "$CAIRN_SOURCE/deploy/monitoring/rules.yml" | sort -u | diff - alerts ||
  die "docs/monitoring.md and the rules have other alerts"

# A disk that takes nothing makes it unready, and a monitor's critical, until it does again; it lives all the while.
mv home/store moved
exits 1 cairn submit landmark_map log.h5 --seed 2
until_true 10 answers 503 /readyz
grep -q '^the store cannot be written' answer || die "not the reason: $(cat answer)"
answers 200 /healthz || die "it is not healthy"
exits 2 cairn status --check
says '^CAIRN CRITICAL: the store cannot be written: '
mv moved home/store
until_true 10 answers 200 /readyz
exits 0 cairn status --check

kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"

for log in coordinator.log worker.log; do
  [ -s $log ] || die "$log is empty"
  ! grep -vE '^\{("[a-z]+":("([^"\\]|\\.)*"|[0-9]+),?)+\}$' $log || die "$log has lines that are no JSON"
  ! grep -vE '"time":"20[0-9-]+T[0-9:.+-]+"' $log || die "$log has lines without a time"
  ! grep -v '"level":"\(info\|warning\|error\)"' $log || die "$log has lines without a level"
  ! grep -v '"message":"' $log || die "$log has lines without a message"
done
