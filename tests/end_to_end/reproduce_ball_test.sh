#!/usr/bin/env bash
# Table and figures on learned landmarks from one command: all pictures are there, the samples and results beside them
# give the same numbers by hand, a second call computes nothing anew.
source "$(dirname "$0")/common.sh"

line=$(cairn-reproduce ball --help | examples_in)
[ "$line" = 'cairn-reproduce ball --seeds 5 --out ball' ] || die "its example is another: $line"
# Not five corridors, which take a quarter of an hour.
exits 0 ${line/--seeds 5/--seeds 1 --seed 7 --steps 30} --json
grep -q '</html>' ball/index.html || die "the page is cut off"
pictures=$(grep -oE 'src="[^"]*"' ball/index.html | cut -d'"' -f2)
[ "$(wc -w <<<"$pictures")" -eq 6 ] || die "the page does not show six figures"
for picture in $pictures; do
  head -c 8 "ball/$picture" | grep -q PNG || die "$picture is no PNG"
done
for row in 'doors, lights: detected' 'doors, lights: perfect' 'BaLL, n = 1' 'BaLL, n = 4'; do
  grep -q "\"$row\"" stdout || die "table 3 lacks '$row'"
done

# The held-out run is scored, and nothing else.
exits 0 cairn evaluate ball/results/d2_7/n4_w2.h5 --truth ball/inputs/d2_7_samples.h5
[ "$(awk '/^trained_on/ {on = 0} on && NR > 1 {print} /^runs$/ {on = 1}' stdout | sed 's/  */ /g')" = " name samples
 d2 run 4 808" ] || die "another run than the one held out was scored: $(cat stdout)"
exits 0 cairn evaluate ball/results/d2_7/locate.h5 --truth ball/inputs/d2_7_samples.h5
says '^traverses +35$'
says '^runs +d2 run 4$'
says 'nothing known at the start$'

before=$(stat -c '%i %Y' ball/results/d1_7/n1_w1.h5)
exits 0 cairn-reproduce ball --seeds 1 --seed 7 --steps 30 --out ball
[ "$before" = "$(stat -c '%i %Y' ball/results/d1_7/n1_w1.h5)" ] || die "a finished result was computed again"
refuses 'force' cairn-reproduce ball --seeds 1 --seed 7 --steps 31 --out ball
refuses 'seeds' cairn-reproduce ball --seeds 0 --out ball
