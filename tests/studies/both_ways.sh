#!/usr/bin/env bash
# A simulated corridor driven one way against both ways: error reduction within +-2 m, and the way after which a robot that
# knew nothing is found to within 1 m. Three runs of each way are trained on, one of each is scored on and localised in;
# seeds are corridors. Means over the seeds with their 95% intervals.
#   tests/studies/both_ways.sh [SET [FIRST [LAST]]]     d1 101 105: some minutes of a core
set -euo pipefail
here=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$here/build/release/bin:$PATH
set_name=${1:-d1} first=${2:-101} last=${3:-105}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

quietly() { "$@" >log 2>&1 || { cat log >&2; exit 1; }; }
learn() {  # file, unseen runs, heading_window_deg, out
  quietly cairn run landmark_learning "$1" --set unseen="$2" --set heading_window_deg="$3" --set rate=0.02 \
    --set weight_decay=0.01 --set steps=500 --out "$4" --force
}
# Prints a row: reduction in percent, way in m until below 1 m (the whole way where it never is), share of facing right there.
score() {  # name, file, networks, heading_window_deg, heading
  quietly cairn run localization "$2" --input networks="$3/landmark_learning.h5" --set belief=grid --set heading="$5" \
    --out where --force
  cairn evaluate "$3" --truth "$2" --heading-window-deg "$4" --json >reduction.json
  cairn evaluate where --truth "$2" --json >error.json
  python3 -c '
import json, sys
reduction = [w["error_reduction"] for w in json.load(open("reduction.json"))["windows"] if w["window_m"] == 2][0]
score = json.load(open("error.json"))
way = score["under_1m_after_m"]
print(sys.argv[1], 100 * reduction, score["rows"][-1]["travelled_m"] if way is None else way,
      [r["error"]["mean_m"] for r in score["rows"] if r["sensations"] == 20][0], sep=",")' "$1" >>rows
}
for seed in $(seq "$first" "$last"); do
  quietly cairn simulate corridor --set "$set_name" --seed "$seed" --force one.h5
  quietly cairn simulate corridor --set "$set_name" --seed "$seed" --runs 8 --both-ways --force both.h5
  learn one.h5 "$set_name run 4" 180 one
  learn both.h5 "$set_name run 7,$set_name run 8 back" 90 known
  learn both.h5 "$set_name run 7,$set_name run 8 back" 180 unknown
  score "one way" one.h5 one 180 known
  score "both ways, heading known" both.h5 known 90 known
  score "both ways, heading unknown" both.h5 unknown 180 unknown
  score "both ways, headings ignored" both.h5 unknown 180 ignored
done
python3 - "$set_name" "$first" "$last" <<'PYTHON'
import math, sys
T = {1: 12.706, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306, 9: 2.262}
rows = {}
for line in open("rows"):
    name, *values = line.strip().rsplit(",", 3)
    rows.setdefault(name, []).append([float(v) for v in values])
def over(values):
    n = len(values)
    mean = sum(values) / n
    if n < 2: return "%.1f" % mean
    sd = math.sqrt(sum((v - mean) ** 2 for v in values) / (n - 1))
    return "%5.1f +- %4.1f" % (mean, T.get(n - 1, 1.96) * sd / math.sqrt(n))
print("%s, corridors %s to %s" % tuple(sys.argv[1:]))
print("%-30s %-18s %-18s %s" % ("", "reduction +-2 m %", "under 1 m after m", "error after 10 m"))
for name, values in rows.items():
    print("%-30s %-18s %-18s %s" % (name, *[over([v[i] for v in values]) for i in range(3)]))
PYTHON
