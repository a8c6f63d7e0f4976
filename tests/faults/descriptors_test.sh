#!/usr/bin/env bash
# More connections than the coordinator may have files open: those that are too many are turned away and counted, the
# service neither dies nor spins, saves what it must, and answers.
source "$(dirname "$0")/../end_to_end/common.sh"
command -v python3 >/dev/null || skip "python3 makes the connections"

simulate log.h5
(ulimit -n 64 && exec cairn coordinator) >coordinator.log 2>&1 &
coordinator=$!
until_true 20 cairn list >/dev/null
socket=$(find "$CAIRN_HOME" -type s)
[ -S "$socket" ] || die "where does it listen?"

# Holds 200 connections, each made again when it was closed, until it is told to end.
cat >crowd.py <<'END'
import socket, sys, time

def connect():
    s = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    s.setblocking(False)
    try:
        s.connect(sys.argv[1])
    except BlockingIOError:
        pass
    return s

crowd = [connect() for _ in range(200)]
print("there", flush=True)
while True:
    time.sleep(0.2)
    for i, s in enumerate(crowd):
        try:
            if s.recv(4096) != b"":
                continue
        except BlockingIOError:
            continue
        except OSError:
            pass
        s.close()
        crowd[i] = connect()
END
python3 crowd.py "$socket" >crowd.out &
crowd=$!
until_true 20 grep -q there crowd.out

# The processor time of the coordinator, in hundredths of a second.
used() { awk '{print $14 + $15}' "/proc/$coordinator/stat"; }
before=$(used)
sleep 3
after=$(used)
[ -d "/proc/$coordinator" ] || die "the coordinator died"
[ $((after - before)) -lt 200 ] || die "it spins: $((after - before)) hundredths of a second in three seconds"
[ "$(find "/proc/$coordinator/fd" -mindepth 1 | wc -l)" -le 64 ] || die "that is more than it may open"

kill "$crowd"
wait "$crowd" 2>/dev/null || true
until_true 20 cairn list >/dev/null
exits 0 cairn list
says '^refused .*connections [0-9]+'
cairn worker 2>worker.log &
exits 0 cairn submit landmark_map log.h5 --set iterations=1
exits 0 cairn watch
kill -TERM "$coordinator"
wait "$coordinator" || die "the coordinator did not end in good order"
