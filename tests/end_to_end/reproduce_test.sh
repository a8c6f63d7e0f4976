#!/usr/bin/env bash
# The papers' figures from one command: every picture of the page is there, and a second call computes nothing anew.
source "$(dirname "$0")/common.sh"

line=$(example reproduce landmarks)
[ "$line" = 'cairn reproduce landmarks --out figures' ] || die "its example is another: $line"
exits 0 $line --json
number=$(grep -c '"file": "' stdout)
[ "$number" -ge 12 ] || die "only $number figures"
grep -q '</html>' figures/index.html || die "the page is cut off"
pictures=$(grep -oE 'src="[^"]*"' figures/index.html | cut -d'"' -f2)
[ "$(wc -w <<<"$pictures")" -eq "$number" ] || die "the page does not show every figure"
for picture in $pictures; do
  head -c 8 "figures/$picture" | grep -q PNG || die "$picture is no PNG"
done

# The map is right, in the picture's own words, and the logs beside it give it again.
grep '"measured": "topology right' stdout >/dev/null || die "figure 6 is not right"
exits 0 cairn evaluate figures/results/map.h5 --truth figures/inputs/first.h5 --json
[ "$(number correct stdout)" = true ] || die "evaluate says the map is wrong"

before=$(stat -c '%i %Y' figures/results/map.h5)
exits 0 cairn reproduce landmarks --out figures
[ "$before" = "$(stat -c '%i %Y' figures/results/map.h5)" ] || die "a finished result was computed again"
refuses 'force' cairn reproduce landmarks --out figures --seed 8
