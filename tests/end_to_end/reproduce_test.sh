#!/usr/bin/env bash
# The papers' figures from one command: every picture of the page is there, and a second call computes nothing anew.
source "$(dirname "$0")/common.sh"

line=$(cairn-reproduce landmarks --help | examples_in)
[ "$line" = 'cairn-reproduce landmarks --out figures' ] || die "its example is another: $line"
exits 0 $line --json
number=$(grep -c '"file": "figure\|"file": "forward' stdout)
[ "$number" -ge 12 ] || die "only $number figures"
grep -q '</html>' figures/index.html || die "the page is cut off"
pictures=$(grep -oE 'src="[^"]*"' figures/index.html | cut -d'"' -f2)
[ "$(wc -w <<<"$pictures")" -eq "$number" ] || die "the page does not show every figure"
for picture in $pictures; do
  head -c 8 "figures/$picture" | grep -q PNG || die "$picture is no PNG"
done

# Each claim that does not hold on this log is one of those that docs/reproduce.md names as differing; no other,
# and none of them has come true unnoticed.
differing=$(grep -B4 '"holds": false' stdout | grep -o '"title": "[^"]*"' | cut -d'"' -f4)
[ "$differing" = "Section 6: the topology after two iterations
Figure 8: where the robot may be at the last step" ] || die "claims that do not hold here: $differing"
while read -r title; do
  grep -qF "$title" "$CAIRN_SOURCE/docs/reproduce.md" || die "docs/reproduce.md does not say that '$title' differs"
done <<<"$differing"
[ "$(grep -c '"holds": true' stdout)" -ge 13 ] || die "few claims are checked"

says 'a hundredth of its mass or more at (1 place|[0-9]+ places) \(told apart'
grep -q 'checked is whether its topology is right' figures/index.html || die "the page does not say what is checked"

# The map is right, in the picture's own words, and the logs beside it give it again.
grep '"measured": "plain EM: topology right' stdout >/dev/null || die "figure 6 is not right"
exits 0 cairn evaluate figures/results/map.h5 --truth figures/inputs/first.h5 --json
[ "$(number correct stdout)" = true ] || die "evaluate says the map is wrong"

before=$(stat -c '%i %Y' figures/results/map.h5)
exits 0 cairn-reproduce landmarks --out figures
[ "$before" = "$(stat -c '%i %Y' figures/results/map.h5)" ] || die "a finished result was computed again"
refuses 'force' cairn-reproduce landmarks --out figures --seed 8
