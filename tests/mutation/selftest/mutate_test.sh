#!/usr/bin/env bash
# The tool on a sample: it kills what a test notices, and says what none does. `shared_m > 0` against `>= 0` is the same
# function; ShareOfFirst has no test at all.
set -euo pipefail
cd "${CAIRN_SOURCE:?}"
command -v python3 >/dev/null || { echo "SKIPPED: there is no python3"; exit 77; }
code=0
said=$(tests/mutation/mutate.py --build "${CAIRN_BUILD:?}" --count 0 --program mutation_sample_test \
  tests/mutation/selftest/sample.cc) || code=$?
echo "$said"
die() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
[ $code -eq 1 ] || die "exit code $code, not 1: some survive"
expected='killed std::min -> std::max
killed - -> +
killed std::max -> std::min
SURVIVED > -> >=
SURVIVED / -> *
SURVIVED - -> +'
found=$(sed -nE 's/^(killed|SURVIVED) +[0-9a-f]{8} [^ ]+: (\S+ -> \S+):.*/\1 \2/p' <<<"$said")
[ "$found" = "$expected" ] || die "not the verdicts that are expected: $found"
grep -q '^killed .*| Shared.IsWhatTwoIntervalsHaveInCommon$' <<<"$said" || die "who killed is not said"
grep -q '^== these files: 3 killed, 3 survived, 0 do not compile$' <<<"$said" || die "the sum is wrong"

# A draw depends on its seed and on nothing else.
draw() { tests/mutation/mutate.py --list --count 5 --seed "$1" evidence_map; }
[ "$(draw 1)" = "$(draw 1)" ] && [ "$(draw 1 | wc -l)" -eq 5 ] || die "a draw is not given again"
[ "$(draw 1)" != "$(draw 2)" ] || die "the seed changes nothing"
# Every core's files are there and have something to change.
grep -v '^#' tests/mutation/cores.txt | while read -r core _; do
  tests/mutation/mutate.py --list --count 1 "$core" >/dev/null || die "core $core"
done
# What is named as equivalent still stands in the sources.
every=$(grep -v '^#' tests/mutation/cores.txt | cut -d' ' -f1 | xargs tests/mutation/mutate.py --list --count 0 --equivalent)
while read -r id _; do
  [[ -z $id || $id = '#'* ]] || grep -q "^$id " <<<"$every" || die "equivalent.txt names $id, which is no mutant any more"
done <tests/mutation/equivalent.txt
