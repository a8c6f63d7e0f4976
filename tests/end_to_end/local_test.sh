#!/usr/bin/env bash
# Local maps of an office: better than odometry by much; the same bits on 1, 2 and 5 workers, killed and resumed or not; what
# a log lacks is said. Where CAIRN_DATA is set, the Intel Research Lab's raw odometry too.
source "$(dirname "$0")/common.sh"

cairn simulate office --seed 21 --minutes 5 log.h5 >/dev/null
job=(cairn run local_map log.h5)
for workers in 1 2 5; do exits 0 "${job[@]}" --workers "$workers" --out "by$workers"; done
same_bits by1 by2
same_bits by1 by5

"${job[@]}" --workers 2 --out killed >background.out 2>background.err &
run=$!
saved_or_ended() { find killed/.cairn -name '*.h5' 2>/dev/null | grep -q . || ! kill -0 "$run" 2>/dev/null; }
until_true 60 saved_or_ended
kill -9 "$run" 2>/dev/null || die "the run was over before it could be killed: $(cat background.err)"
wait "$run" 2>/dev/null || true
exits 0 "${job[@]}" --workers 2 --out killed
same_bits by1 killed

cairn evaluate by1 --truth log.h5 --json >score.json || die "evaluate fails"
awk -v mean="$(number mean_m score.json)" -v odometry="$(number odometry_mean_m score.json)" \
  'BEGIN {exit !(mean < 0.25 && mean < odometry)}' || die "the path is no better than that: $(cat score.json)"

# Its poses are those of a map.
printf '%s\n' 'name: chain' 'seed: 1' 'inputs: {log: log.h5}' 'stages:' '  - {name: local, pipeline: local_map, log: log}' \
  '  - {name: grid, pipeline: evidence_map, log: log, poses: local}' >chain.yaml
exits 0 cairn run chain.yaml --out chain

cairn simulate loop --difficulty paper --seed 7 blind.h5 >/dev/null
refuses 'no range scans' cairn run local_map blind.h5 --out blind

[ -n "${CAIRN_DATA:-}" ] || { printf 'CAIRN_DATA is unset: real logs skipped\n'; exit 0; }
intel=$CAIRN_DATA/carmen-intel
cairn import carmen "$intel/intel-raw.log.gz" intel.h5 >/dev/null 2>&1
exits 0 cairn run local_map intel.h5 --out intel
for from in intel.h5 intel; do
  cairn evaluate "$from" --relations "$intel/intel.relations.gz" --json >"$(basename "$from" .h5).$([ -d "$from" ] && echo map || echo raw).json"
done
awk -v map="$(number translation_m intel.map.json)" -v raw="$(number translation_m intel.raw.json)" \
  'BEGIN {exit !(3 * map < raw)}' || die "Intel: $(cat intel.map.json)"
