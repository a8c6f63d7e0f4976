#!/usr/bin/env bash
# Studies that read what `cairn` prints find their figures in it, each with the least that it takes; where a figure is not there
# they fail.
source "$(dirname "$0")/common.sh"
command -v python3 >/dev/null || skip "there is no python3"
studies=$CAIRN_SOURCE/tests/studies
export STEPS=2

# rows COUNT PATTERN: so many lines of the last output.
rows() { [ "$(grep -Ec -- "$2" stdout)" -eq "$1" ] || die "not $1 lines like '$2': $(cat stdout)"; }

NETWORKS=1 exits 0 "$studies/ball_labels.sh" 101 d3
rows 2 '^d3, labels 0\.[13] m off, n = 1: [0-9.]+%$'
exits 0 "$studies/training_methods.sh" d1 21
rows 8 ' 2 +[0-9.]+% +-?[0-9.]+% +[0-9.]+$'

# A `cairn` whose `evaluate` finds nothing.
mkdir bin
cat >bin/cairn <<END
#!/bin/sh
[ "\$1" != evaluate ] || exec echo '{"windows": []}'
exec '$CAIRN_BIN/cairn' "\$@"
END
chmod +x bin/cairn
CAIRN_BIN=$work/bin exits 1 "$studies/ball_labels.sh" 101 d3
says 'no error reduction in a window of 2 m'

if [ -d "${CAIRN_DATA:-}/pioneer-sonar-laser" ]; then
  exits 0 "$studies/heldout.sh" pioneer1-sonar
  rows 1 '^pioneer1-sonar +-?[0-9.]+ +-?[0-9.]+$'
  CAIRN_BIN=$work/bin exits 1 "$studies/heldout.sh" pioneer1-sonar
  says "no figure: log-likelihood a reading of evidence_map on pioneer1-sonar is ''"
fi
if [ -d "${CAIRN_DATA:-}/sussex-route" ]; then
  ROWS='1 2' exits 0 "$studies/sussex.sh" 1 steps=2
  rows 1 '^\| \+-2 m \| 1 \| -?[0-9.]+% \|'
fi
