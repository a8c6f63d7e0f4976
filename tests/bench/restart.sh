#!/usr/bin/env bash
# How long a coordinator with 100 unfinished jobs in its store takes from its start to its first task out.
# Usage: restart.sh [JOBS]; CAIRN_BIN: the folder of the programs. Each job has a log of its own. The coordinator is
# killed, so that its store is as a crash leaves it; it hands out a task in the step in which it says that a worker
# joined, so that line is waited for. Prints one line a run, of five.
set -euo pipefail
jobs=${1:-100}
PATH=$(realpath "${CAIRN_BIN:?}"):$PATH
work=$(mktemp -d)
export CAIRN_HOME=$work/home
trap 'jobs -p | xargs -r kill -9 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"

mkdir logs
for ((i = 0; i < jobs; ++i)); do cairn simulate loop --difficulty paper --seed "$i" "logs/$i.h5" >/dev/null; done
cairn coordinator 2>coordinator.log &
coordinator=$!
until cairn list >/dev/null 2>&1; do sleep 0.05; done
cairn submit landmark_map --each 'logs/*.h5' >submitted
[ "$(wc -l <submitted)" -eq "$jobs" ]
for run in 1 2 3 4 5; do
  kill -9 "$coordinator"
  wait "$coordinator" 2>/dev/null || true
  : >coordinator.log
  start_ns=$(date +%s%N)
  cairn coordinator 2>coordinator.log &
  coordinator=$!
  cairn worker 2>/dev/null &
  worker=$!
  until grep -q joined coordinator.log; do sleep 0.005; done
  end_ns=$(date +%s%N)
  kill -9 "$worker"
  wait "$worker" 2>/dev/null || true
  unfinished=$(cairn list | grep -cE ' (queued|running) ') || { echo "no job is unfinished" >&2; exit 1; }
  echo "run $run: $(((end_ns - start_ns) / 1000000)) ms to the first task out, $unfinished jobs unfinished, store" \
    "$(du -sk home/store | cut -f1) kB"
done
