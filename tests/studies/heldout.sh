#!/usr/bin/env bash
# Which map tells more of readings that it has not seen: log-likelihood a reading, of a tenth of each recorded log held
# out in ten blocks of time, under the maps of evidence_map and of forward_map, both as by default and both scored by
# the same forward model, fitted to each on the other nine tenths (`cairn evaluate`). Needs CAIRN_DATA.
#
#   tests/studies/heldout.sh [NAME...]      # logs by name; without one, all. CAIRN_BIN: the folder of the programs
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source-path=SCRIPTDIR
source tests/studies/common.sh
data=${CAIRN_DATA:?names no folder: where are the recorded logs?}
cairn=$(realpath "${CAIRN_BIN:-build/release/bin}")/cairn
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

carmen() { "$cairn" import carmen "$data/$1" log.h5 --skip-bad "${@:2}"; }
names=("$@")
[ $# -gt 0 ] || names=(intel fr079 belgioioso fhw-museum pioneer1-sonar pioneer1-laser pioneer2-sonar pioneer2-laser
  pioneer4-sonar pioneer4-laser wean1 wean3 loop5)
printf '%-16s %12s %12s\n' log evidence_map forward_map
for name in "${names[@]}"; do
  rm -f log.h5
  sensors=
  case $name in
    intel) carmen carmen-intel/intel-corrected.log.gz ;;
    fr079) carmen carmen-fr079/freiburg-079-corrected.log.gz ;;
    belgioioso) carmen carmen-belgioioso/belgioioso-corrected.log.gz --numbered ;;
    fhw-museum) carmen carmen-fhw-museum/fhw-corrected.log.gz ;;
    pioneer*) "$cairn" import pioneer "$data/pioneer-sonar-laser/run${name:7:1}" log.h5; sensors=${name#*-} ;;
    wean*) "$cairn" import wean "$data/wean-hall/robotdata${name:4}.log.gz" log.h5 ;;
    loop5) "$cairn" import dpslam "$data/dpslam-loop5/loop5.log.gz" log.h5 ;;
    *) echo "there is no log '$name'" >&2; exit 2 ;;
  esac > import.txt 2>&1 || { cat import.txt >&2; exit 1; }
  line=
  for pipeline in evidence_map forward_map; do
    "$cairn" run "$pipeline" log.h5 --set heldout=0.1 --set sensors="$sensors" --out "$name-$pipeline" \
      > run.txt 2>&1 || { cat run.txt >&2; exit 1; }
    score=$("$cairn" evaluate "$name-$pipeline" --truth log.h5 |
      awk '$1 == "heldout.log_likelihood_per_reading" { print $2 }')
    score=$(figure "log-likelihood a reading of $pipeline on $name" "$score")
    line+=$(printf ' %12s' "$score")
  done
  printf '%-16s%s\n' "$name" "$line"
done
