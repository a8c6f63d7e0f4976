#!/usr/bin/env bash
# Figures on the pages are what their commands print: those of commands that take some seconds. The check itself fails where a
# figure is wrong, a command fails or prints nothing, a block has no figure, or a page has no marker.
source "$(dirname "$0")/common.sh"
command -v python3 >/dev/null || skip "there is no python3"
figures=(python3 "$CAIRN_SOURCE/tests/studies/figures.py")

exits 0 "${figures[@]}" --quick
says '[1-9][0-9]* figures are what their commands print; 0 blocks are not'

# of TEXT CODE: a page of that text ends with that code. A line is a row of a table where it begins with '|'.
of() {
  printf '%s\n' "$1" >page.md
  exits "$2" "${figures[@]}" page.md
}
table=$'| what | figure |\n| --- | --- |'
of "<!-- printed by: echo 0.0364 m, 9461 of 7 -->
$table
| in 3 offices | D-1: 0.036 m; 9,461 of 7; 2.5 to 3.1 s; \`--set a=5\`; *0.99* |" 0
says 'page.md:2: 3 figures'
of "<!-- printed by: echo 0.0364 m -->
$table
| in 3 offices | 0.037 m |" 1
says 'FAILED: .*page.md:2: 0.037 not printed by echo 0.0364 m'
of '<!-- printed by: echo 20 of 20, 0.5 m -->
A paragraph of 1998: 0.5 m off, 12% of it lost.' 1
says ': 12 not printed by'
of '<!-- printed by: the last column -->
| what | figure | command |
| --- | --- | --- |
| right | 4 | `echo 4` |
| not said | 5 | by hand |
| wrong | 6 | `echo 7 \| cat` |' 1
says 'page.md:4: 1 figures'
says 'FAILED: .*page.md:6: 6 not printed by echo 7 \| cat'
of $'<!-- printed by: true -->\nIt is 0.5 m.' 1
says 'FAILED: true: prints nothing'
of $'<!-- printed by: echo 0.5; false -->\nIt is 0.5 m.' 1
says 'FAILED: echo 0.5; false: exit code 1'
of $'<!-- printed by: echo 0.5 -->\nIt is right.' 1
says 'no figure stands below the marker'
of 'It is 0.5 m.' 1
says 'no block has a marker'
CAIRN_DATA=$work of "<!-- printed by: ls \"\$CAIRN_DATA/nothing-there\" -->
It is 0.5 m." 0
says 'skipped: page.md:2: \$CAIRN_DATA/nothing-there is missing'
