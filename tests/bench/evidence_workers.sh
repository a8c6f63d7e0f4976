#!/usr/bin/env bash
# What a second worker gains on evidence_map: seconds of the round that counts cells and adds them up, with one and
# with two workers, on a log of CARMEN taken many times over; and of the whole job, of which reading the log and handing
# it out is the same for any number.
#
#   tests/bench/evidence_workers.sh LOG.log.gz [TIMES [CELL_M]]      # of CARMEN, corrected; 100 0.05
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source-path=SCRIPTDIR
source tests/studies/common.sh
log=$1 times=${2:-100} cell=${3:-0.05}
cairn=build/release/bin/cairn
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cairn" import carmen "$log" "$folder/log.h5" --skip-bad > /dev/null
build/release/tests/bench/repeat_log "$folder/log.h5" "$times" "$folder/long.h5"

least() { printf '%s\n' "$@" | sort -g | head -1; }

declare -A round job
for turn in 1 2 3 4 5; do  # the quickest: the machine may have other work
  for workers in 1 2; do
    "$cairn" run evidence_map "$folder/long.h5" --set cell_m="$cell" --out "$folder/out$workers" --force --workers "$workers" > "$folder/log" 2>&1
    facts=$("$cairn" inspect "$folder/out$workers/evidence_map.h5")
    job_s=$(figure "the job's seconds" "$(awk '$1 == "provenance/seconds_s" { print $NF }' <<< "$facts")")
    round_s=$(figure "the round's seconds" "$(awk '$1 == "provenance/round/seconds_s" { print $NF }' <<< "$facts")")
    job[$workers]=$(least ${job[$workers]:-} "$job_s")
    round[$workers]=$(least ${round[$workers]:-} "$round_s")
  done
done
"$cairn" diff "$folder/out1" "$folder/out2"
for workers in 1 2; do echo "$workers worker(s): round ${round[$workers]} s, job ${job[$workers]} s"; done
awk -v a="${round[1]}" -v b="${round[2]}" -v c="${job[1]}" -v d="${job[2]}" \
  'BEGIN { printf "two workers against one: round %.2f, job %.2f\n", a / b, c / d }'
