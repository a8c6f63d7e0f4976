#!/usr/bin/env bash
# What goes over the wire of a large log: a log of CARMEN taken many times over, and evidence_map by a coordinator with keys
# on TCP, with one worker and with two: what the coordinator sent until the job was done, in logs, what the second worker
# gains in the round that counts and in the whole job, and the processor time of all three, which says what so many cores
# allow. Then with two workers that see the store's files: what is sent there is all but the log. It wants a quiet machine.
#
#   tests/bench/log_over_tcp.sh LOG.log.gz [TIMES]      # of CARMEN, corrected; 100
#
# BIN: the programs, build/release/bin without it.
set -euo pipefail
cd "$(dirname "$0")/../.."
log=$(realpath "$1") times=${2:-100}
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
metric() { curl -s "$page" | awk -v name="$1" '$1 == name { print $2 }'; }
# processor_s PROCESS…: their processor time.
processor_s() { for process in "$@"; do cat "/proc/$process/stat"; done | awk '{s += $14 + $15} END {print s / '"$(getconf CLK_TCK)"'}'; }

# figure NAME FILE: the last number of an array of one dimension.
figure() { cairn inspect "$2" | awk -v name="$1" '$1 == name { print $NF }'; }
# job OUT WORKERS [OPTION…]: runs the job with so many workers; sets `logs`, `seconds` of the last round, `all` of the job,
# `worked` and `served`, the processor time of workers and coordinator.
job() {
  local out=$1 workers=$2 hub=tcp://127.0.0.1:$((20000 + $$ % 20000)) id before running since
  shift 2
  rm -rf store "$out"
  cairn coordinator --store store --listen "$hub" --metrics 0 2>coordinator.log &
  running=($!)
  awaits grep -q /metrics coordinator.log
  page=$(sed -n 's|.*\(http://127\.0\.0\.1:[0-9]*/metrics\).*|\1|p' coordinator.log)
  awaits cairn list --connect "$hub"
  id=$(cairn submit evidence_map long.h5 --connect "$hub" --json | sed -n 's/.*"id": *"\([^"]*\)".*/\1/p' | head -n 1)
  before=$(metric cairn_sent_bytes_total)
  bytes=$(stat -c %s store/blobs/*.flat)
  since=$(processor_s "${running[0]}")
  for _ in $(seq "$workers"); do
    cairn worker --connect "$hub" "$@" 2>>worker.log &
    running+=($!)
  done
  awaits [ -e "store/results/$id/evidence_map.h5" ]
  served=$(awk -v a="$(processor_s "${running[0]}")" -v b="$since" 'BEGIN {print a - b}')
  worked=$(processor_s "${running[@]:1}")
  sleep 2 # the metrics are of a second ago
  logs=$(awk -v a="$(metric cairn_sent_bytes_total)" -v b="$before" -v bytes="$bytes" 'BEGIN { printf "%.2f", (a - b) / bytes }')
  cairn results "$id" --out "$out" --connect "$hub" >/dev/null 2>&1
  kill "${running[@]}"
  wait "${running[@]}" || true
  seconds=$(figure provenance/round/seconds_s "$out/evidence_map.h5")
  all=$(figure provenance/seconds_s "$out/evidence_map.h5")
}

declare -A round whole most busy
least() { printf '%s\n' "$@" | sort -g | head -1; }
for turn in 1 2 3; do # the quickest: the machine may have other work
  for workers in 1 2; do
    job "out$workers" "$workers"
    printf 'turn %d, %d worker(s): round %.2f s, job %.2f s, %s logs sent; processor time: coordinator %.2f s, workers %.2f s\n' \
      "$turn" "$workers" "$seconds" "$all" "$logs" "$served" "$worked"
    round[$workers]=$(least ${round[$workers]:-} "$seconds")
    whole[$workers]=$(least ${whole[$workers]:-} "$all")
    busy[$workers]=$(least ${busy[$workers]:-} "$(awk -v a="$worked" -v b="$served" 'BEGIN {print a + b}')")
    most[$workers]=$(printf '%s\n' ${most[$workers]:-} "$logs" | sort -g | tail -1)
  done
done
cairn diff out1/evidence_map.h5 out2/evidence_map.h5
awk -v a="${round[1]}" -v b="${round[2]}" -v c="${whole[1]}" -v d="${whole[2]}" \
  'BEGIN { printf "two workers against one: round %.2f times, job %.2f times as fast\n", a / b, c / d }'
awk -v cores="$(nproc)" -v a="${whole[1]}" -v b="${busy[2]}" 'BEGIN { if (cores > 3) cores = 3
  printf "they and the coordinator took %.2f s of processor time: on %d cores the job could be %.2f times as fast as with one\n",
    b, cores, a / (b / cores) }'
job shared 2 --shared-path "$folder/store/blobs"
cairn diff out1/evidence_map.h5 shared/evidence_map.h5
awk -v a="${most[2]}" -v b="$logs" -v bytes="$bytes" \
  'BEGIN { printf "two workers were sent the log of %d bytes %.2f times, and %.2f logs of all else\n", bytes, a - b, b }'
