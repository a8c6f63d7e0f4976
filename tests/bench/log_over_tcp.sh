#!/usr/bin/env bash
# What goes over the wire of a large log: a log of CARMEN taken many times over, and evidence_map by a coordinator with keys
# on TCP, with one worker and with two: what the coordinator sent until the job was done, in logs, what the second worker
# gains in the round that counts and in the whole job, and the processor time of all. Beside it what the machine allows at
# that time: in each turn the job with one worker also runs twice at once, each with a coordinator of its own; two workers
# cannot gain more in a round than those two do together. Then with two workers that see the store's files: what is sent
# there is all but the log. It wants a quiet machine.
#
#   tests/bench/log_over_tcp.sh LOG.log.gz [TIMES [TURNS]]      # of CARMEN, corrected; 100 and 5
#
# BIN: the programs, build/release/bin without it.
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source-path=SCRIPTDIR
source tests/studies/common.sh
log=$(realpath "$1") times=${2:-100} turns=${3:-5}
repeat=$PWD/build/release/tests/bench/repeat_log
PATH=$(realpath "${BIN:-build/release/bin}"):$PATH
folder=$(mktemp -d)
cleanup() {
  jobs -p | xargs -r kill 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT
export HOME=$folder XDG_CONFIG_HOME=$folder/config
cd "$folder"
cairn import carmen "$log" log.h5 --skip-bad >/dev/null
"$repeat" log.h5 "$times" long.h5
for name in coordinator worker client; do cairn keys new "$name" >/dev/null; done
cairn keys allow config/cairn/worker.pub --as worker >/dev/null
cairn keys allow config/cairn/client.pub --as submitter >/dev/null

# awaits COMMAND…: until it succeeds, for at most five minutes. One that costs little: there may be no core to spare.
awaits() {
  for _ in $(seq 3000); do
    if "$@" >/dev/null 2>&1; then return; fi
    sleep 0.1
  done
  echo "never: $*" >&2
  return 1
}
# metric PAGE NAME: of a coordinator.
metric() { figure "$2" "$(curl -s "$1" | awk -v name="$2" '$1 == name { print $2 }')"; }
# processor_s PROCESS…: their processor time.
processor_s() { for process in "$@"; do cat "/proc/$process/stat"; done | awk '{s += $14 + $15} END {print s / '"$(getconf CLK_TCK)"'}'; }

# last NAME FILE: the last number of an array of one dimension.
last() { figure "$1" "$(cairn inspect "$2" | awk -v name="$1" '$1 == name { print $NF }')"; }
# job NAME WORKERS [OPTION…]: runs the job with so many workers, in a folder of that name. Its `figures` are the seconds
# of the last round and of the job, the logs sent, and the processor time of coordinator and workers. Where there is a
# pipe `go`, its workers start as somebody opens that for writing.
job() (
  name=$1 workers=$2
  shift 2
  trap 'jobs -p | xargs -r kill 2>/dev/null || true; wait || true' EXIT
  rm -rf "$name" && mkdir "$name" && cd "$name"
  hub=tcp://127.0.0.1:$((20000 + BASHPID % 20000))
  cairn coordinator --store store --listen "$hub" --metrics 0 2>coordinator.log &
  coordinator=$!
  awaits grep -q /metrics coordinator.log
  page=$(sed -n 's|.*\(http://127\.0\.0\.1:[0-9]*/metrics\).*|\1|p' coordinator.log)
  awaits cairn list --connect "$hub"
  id=$(cairn submit evidence_map ../long.h5 --connect "$hub" --json | sed -n 's/.*"id": *"\([^"]*\)".*/\1/p' | head -n 1)
  before=$(metric "$page" cairn_sent_bytes_total)
  bytes=$(stat -c %s store/blobs/*.flat)
  since=$(processor_s "$coordinator")
  touch ready
  if [ -p ../go ]; then : <../go; fi
  running=()
  for _ in $(seq "$workers"); do
    cairn worker --connect "$hub" "$@" 2>>worker.log &
    running+=($!)
  done
  awaits [ -e "store/results/$id/evidence_map.h5" ]
  served=$(awk -v a="$(processor_s "$coordinator")" -v b="$since" 'BEGIN {print a - b}')
  worked=$(processor_s "${running[@]}")
  sleep 2 # the metrics are of a second ago
  after=$(metric "$page" cairn_sent_bytes_total)
  logs=$(awk -v a="$after" -v b="$before" -v bytes="$bytes" \
    'BEGIN { printf "%.2f", (a - b) / bytes }')
  cairn results "$id" --out out --connect "$hub" >/dev/null 2>&1
  round_s=$(last provenance/round/seconds_s out/evidence_map.h5)
  job_s=$(last provenance/seconds_s out/evidence_map.h5)
  echo "$round_s $job_s $logs $served $worked" >figures
)
# say TURN NAME WHAT
say() {
  awk -v turn="$1" -v what="$3" '{ printf "turn %d, %s: round %.2f s, job %.2f s, %s logs sent; processor time: coordinator %.2f s, workers %.2f s\n",
    turn, what, $1, $2, $3, $4, $5 }' "$2/figures"
}

: >all
for turn in $(seq "$turns"); do
  job one 1
  job two 2
  mkfifo go
  job left 1 &
  job right 1 &
  awaits [ -e left/ready ]
  awaits [ -e right/ready ]
  sleep 0.2 # until both wait
  : >go
  wait
  rm go
  say "$turn" one "one worker"
  say "$turn" two "two workers"
  say "$turn" left "one worker beside another job"
  say "$turn" right "and that"
  cat one/figures two/figures left/figures right/figures | paste -sd ' ' >>all
done
cairn diff one/out/evidence_map.h5 two/out/evidence_map.h5
# median COLUMNS…: of an expression of the turns' figures: of one worker from 1, of two from 6, of the jobs side by side
# from 11 and 16.
median() { awk "{ print $1 }" all | sort -g | awk '{ v[NR] = $1 } END { m = int((NR + 1) / 2); printf "%.2f", NR % 2 ? v[m] : (v[m] + v[m + 1]) / 2 }'; }
echo "medians of $turns turns:"
echo "two workers against one: round $(median '$1 / $6') times as fast; two jobs of one worker side by side: $(median '2 * $1 / (($11 + $16) / 2)') times one of them"
echo "the job: $(median '$2 / $7') times as fast; side by side $(median '2 * $2 / (($12 + $17) / 2)')"
echo "processor time, s: one worker $(median '$5'), its coordinator $(median '$4'); two workers $(median '$10'), their coordinator $(median '$9')"
job shared 2 --shared-path "$folder/shared/store/blobs"
cairn diff one/out/evidence_map.h5 shared/out/evidence_map.h5
echo "two workers were sent the log $(median '$8') times, and $(cut -d' ' -f3 shared/figures) logs of all else"
