#!/usr/bin/env bash
# A service for several people, over TCP with keys: whose job is whose, what each may have and until when, a new key for an
# old one, what is run when a job ends, and a build that drains.
source "$(dirname "$0")/common.sh"

simulate log.h5
for name in coordinator chief ann bob worker; do exits 0 cairn keys new "$name"; done
keys=$HOME/.config/cairn
cp "$keys/coordinator.pub" . # keys of people are named one by one
exits 0 cairn keys allow "$keys/worker.pub" --as worker
exits 0 cairn keys allow "$keys/chief.pub" --as admin
exits 0 cairn keys allow "$keys/ann.pub" --as submitter --limits jobs=2
says 'as submitter, jobs=2$'
exits 0 cairn keys allow "$keys/bob.pub" --as submitter --until "$(date -u -d '+3 days' +%F)"
refuses "'job=2' is no limit" cairn keys allow "$keys/bob.pub" --as submitter --limits job=2
refuses '2001-02-03 is over' cairn keys allow "$keys/bob.pub" --as submitter --until 2001-02-03
exits 0 cairn keys show
says ' submitter,jobs=2  ann$'

cat >hook <<'END'
#!/bin/sh
cat >>"$HOME/ended"
END
chmod +x hook
refuses 'no program that can be run' cairn coordinator --listen tcp://127.0.0.1:1 --on-end ./nothing
refuses "'jobs' is no limit" cairn coordinator --listen tcp://127.0.0.1:1 --key-limits jobs
port=$((20000 + RANDOM % 20000))
export CAIRN_COORDINATOR=tcp://127.0.0.1:$port
serve() {
  cairn coordinator --listen "$CAIRN_COORDINATOR" --on-end ./hook "$@" >>coordinator.log 2>&1 &
  coordinator=$!
  until_true 20 as chief list >/dev/null 2>&1
}
as() { # NAME COMMAND…
  local who=$1
  shift
  cairn "$@" --key "$keys/$who.key"
}
submit() { # NAME SEED: a job of his
  exits 0 as "$1" submit landmark_map log.h5 --seed "$2" --json
  id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
}
serve
submit ann 1
anns=$id
submit bob 2
bobs=$id
exits 0 as bob status "$anns"
says '^owner +ann$'
exits 0 as bob list
says '^job +name +owner '
refuses "cannot cancel $anns: it belongs to ann, and the key of bob .* is no administrator's" as bob cancel "$anns"
refuses 'belongs to ann' as bob pause "$anns"
refuses 'belongs to ann' as bob priority "$anns" 3
exits 0 as bob status "$anns"
says '^state +queued'
# By pattern one's own alone.
exits 0 as bob cancel --name '*'
[ "$(cat stdout)" = "$bobs is cancelled" ] || die "bob's pattern took more than his: $(cat stdout)"
refuses 'belongs to bob' as ann delete "$bobs"
exits 0 as chief pause "$anns"
exits 0 as ann status "$anns"
says '^reason +paused by chief \('
exits 1 as chief status --check
says '^CAIRN WARNING: .*1 job paused, not by the owner'
exits 0 as ann resume "$anns"
exits 0 as ann submit landmark_map log.h5 --seed 1 --priority 3
says "^already there: $anns, queued; .*; its priority stays 0, not 3 \(cairn priority $anns 3\)\$"

# Two jobs at a time, and a key that is about to end.
submit ann 3
exits 1 as ann submit landmark_map log.h5 --seed 4
says 'ann .* has 2 jobs that have not ended, the most that may be \(jobs=2\)'
exits 0 as ann list --json
says '"quota": 1'
[ "$(grep -c '"id"' stdout)" = 3 ] || die "a job that was refused is there"
exits 0 as ann status
says "^warning +the key of bob .* is good until $(date -u -d '+3 days' +%F)"
exits 2 as chief status --check # for there is no worker, too
says '^CAIRN CRITICAL: the key of bob'

# A new key for an old one: the jobs stay hers.
exits 0 cairn keys new ann-2
exits 0 cairn keys allow "$keys/ann-2.pub" --as submitter --name ann
says "1 other key is called 'ann', too"
exits 0 as ann-2 pause "$anns"
exits 0 cairn keys revoke "$keys/ann.pub"
says 'revoked 1'
exits 2 as ann list
says 'does not know this key'
exits 0 as ann-2 resume "$anns"
# A key that has asked ten times at once waits, and is answered.
exits 0 cairn keys allow "$keys/bob.pub" --as submitter --limits requests=1
for _ in {1..13}; do exits 0 as bob status "$bobs"; done
# Whose time is over is a stranger.
exits 0 cairn keys allow "$keys/bob.pub" --as submitter --until "$(date -u -d '+2 seconds' +%FT%TZ)"
until_true 20 bash -c "! cairn list --key '$keys/bob.key' >/dev/null 2>&1"
exits 2 as bob list
says 'does not know this key'
exits 0 cairn keys show
says '\(over\)  bob$'

# The coordinator of the old build takes no new jobs, finishes those that it has, and ends.
kill "$coordinator"
wait "$coordinator" || die "the coordinator ended with $?"
serve --drain
exits 1 as ann-2 submit landmark_map log.h5 --seed 5
says 'takes no new jobs'
cairn worker >worker.log 2>&1 &
wait "$coordinator" || die "the draining coordinator ended with $?"
grep -q 'no job runs any more: the service ends' coordinator.log || die "it does not say why it ends"
[ "$(grep -c '"state": "done"' ended)" = 2 ] || die "not two jobs were told of as done: $(cat ended)"
grep -q "\"id\": \"$anns\"" ended || die "the job that ended is not named"
grep -q '"state": "cancelled"' ended || die "a job that was cancelled is not told of"
