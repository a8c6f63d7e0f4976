#!/usr/bin/env bash
# Error reduction on the Sussex route (docs/datasets.md): networks learn from the run `training` and are scored on the
# other, which decides nothing. Prints the median over seeds, with the least and the most, for windows of +-2 m and none.
#   CAIRN_DATA=... tests/studies/sussex.sh [SEEDS [OPTION=VALUE...]]     10 seeds: half an hour of a core
#   ROWS='2 2' CAIRN_DATA=... tests/studies/sussex.sh                    two networks for +-2 m alone
# The ceilings beside them are estimates of what ideal codes of n bits give at positions that look alike.
set -euo pipefail
[ -d "${CAIRN_DATA:-}/sussex-route" ] || { echo "CAIRN_DATA names no folder that holds sussex-route" >&2; exit 2; }
here=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$(realpath "${CAIRN_BIN:-$here/build/release/bin}"):$PATH
seeds=${1:-10}
shift || true
options=()
for option in input_noise=1 hidden=30 rate=0.03 steps=1500 "$@"; do
  for other in "$@"; do [ "${other%%=*}" = "${option%%=*}" ] && [ "$other" != "$option" ] && continue 2; done
  options+=(--set "$option")
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 "$here/docs/sussex_tables.py" "$CAIRN_DATA/sussex-route" track.csv times.csv
quietly() { "$@" >log 2>&1 || { cat log >&2; exit 1; }; }
quietly cairn import images "$CAIRN_DATA/sussex-route" track.csv images.h5 --times times.csv --smooth-s 1 --skip-bad
quietly cairn run image_features images.h5 --out route

row() {  # networks, window_m of training, window to score, name, ceiling
  [[ "$1 $2" =~ ^(${ROWS:-.*})$ ]] || return 0
  for seed in $(seq "$seeds"); do
    quietly cairn run landmark_learning route/image_features.h5 --out learned --force --seed "$seed" \
      --set unseen=infomax_binary --set networks="$1" --set window_m="$2" "${options[@]}"
    cairn evaluate learned --truth route/image_features.h5 --json | "$here/tests/studies/error_reduction.py" "$3"
  done | sort -n | awk -v seeds="$seeds" -v n="$1" -v name="$4" -v ceiling="$5" '
    {v[NR] = $1}
    END {
      if (NR != seeds) exit 1
      m = NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2
      printf "| %s | %d | %.1f%% | %.1f to %.1f%% | about %d%% |\n", name, n, m, v[1], v[NR], ceiling
    }'
}
echo "| window | networks | median of $seeds seeds | least to most | ceiling |"
echo "| --- | --- | --- | --- | --- |"
row 1 2 2 "+-2 m" 30
row 2 2 2 "+-2 m" 53
row 4 2 2 "+-2 m" 59
row 1 0 none "none" 49
row 2 0 none "none" 71
row 4 0 none "none" 83
