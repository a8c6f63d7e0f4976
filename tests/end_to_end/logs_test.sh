#!/usr/bin/env bash
# `cairn logs` tells what happened to a job: a worker that is killed with its task assigned, a coordinator that is killed,
# commands, the end; `cairn status` shows the service meanwhile.
source "$(dirname "$0")/common.sh"

simulate log.h5
serve() {
  cairn coordinator >>coordinator.log 2>&1 &
  coordinator=$!
}
serve
until_true 20 cairn list >/dev/null
refuses 'no job .nobody.; there are none' cairn logs nobody
exits 0 cairn status
says '^jobs +none'
says "^workers +none \(start 'cairn worker'\)"
exits 0 cairn submit landmark_map log.h5 --seed 7 --json
job=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
exits 0 cairn logs "$job"
[ "$(wc -l <stdout)" -eq 1 ] || die "more than its submission is told of a job that waits"
says '^20[0-9-]+T[0-9:]+Z  submitted: 1 stage$'

# A worker is killed while it runs a task. Stopped, it cannot finish it between the look and the kill.
cairn worker >>worker.log 2>&1 &
worker=$!
busy() {
  kill -STOP "$worker"
  cairn status --json >stdout
  [ "$(grep -c '"state": "busy"' stdout)" -gt 0 ] || { kill -CONT "$worker"; return 1; }
}
until_true 30 busy
exits 0 cairn status
says '^workers +1 busy'
says "^1 .* $worker +busy .*$job: .*stage 'landmark_map'"
exits 0 cairn status "$job"
says '^stage +1 of 1, landmark_map'
says '^workers +1 at work on it'
kill -9 "$worker"
told() { cairn logs "$job" | grep -q "warning: .*worker $worker on .* while it ran; it is tried again"; }
until_true 30 told
exits 0 cairn status "$job"
says '^retries +1 in all'
says "worker $worker on .* while it ran"
exits 0 cairn pause "$job"

# The log outlives the coordinator.
cairn logs "$job" >before
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true
serve
until_true 20 cairn list >/dev/null
exits 0 cairn logs "$job"
head -n "$(wc -l <before)" stdout | cmp - before || die "a killed coordinator lost lines: $(cat before)"
says 'the coordinator was started again: stays paused: paused by its owner'

# Followed, it is told to the job's end, each line once.
cairn logs "$job" --follow >followed &
follower=$!
exits 0 cairn resume "$job"
cairn worker >>worker.log 2>&1 &
code=0
wait "$follower" || code=$?
[ "$code" -eq 0 ] || die "cairn logs --follow ended with $code"
exits 0 cairn logs "$job"
cmp followed stdout || die "what was followed is not what the log holds"
says 'Z  resumed, at '
says "Z  stage 'landmark_map', round [0-9]+: [0-9]+ tasks? in .* of work: .*log-likelihood"
says "Z  the result of stage 'landmark_map' is published$"
[ "$(tail -n 1 stdout | cut -d' ' -f3-)" = "done" ] || die "the last line is not the job's end: $(tail -n 1 stdout)"
cairn logs "$job" --json >lines
[ "$(wc -l <lines)" -eq "$(wc -l <followed)" ] || die "--json is not a line each"
head -n 1 lines | grep -Eq '^\{"number":1,"utc":"20.*","level":"info","text":"submitted: 1 stage"\}$' || die "$(head -n 1 lines)"
cairn logs "$job" | head -n 1 >first || true # a reader that goes away is no reason to complain
[ "$(wc -l <first)" -eq 1 ] || die "nothing came through a pipe"

# It goes with its job.
exits 0 cairn delete "$job"
refuses 'there is no job' cairn logs "$job"
