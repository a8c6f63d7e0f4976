#!/usr/bin/env bash
# The simulated corridor: samples, their features made by the simulator and by the pipeline, doors scored.
source "$(dirname "$0")/common.sh"

small="--runs 2 --snapshots 80 --length-m 40 --seed 5"
mkdir pictures
exits 0 cairn simulate corridor --set d1 $small --pictures pictures d1.h5
says '^d1.h5: 2 runs of 80 snapshots, 164 inputs, features: door, door detected$'
[ "$(find pictures -name 'd1 run ?.png' -size +1k | wc -l)" -eq 2 ] || die "no picture for each run"
echo mine >'pictures/d1 run 2.png'
refuses "d1 run 1.png. is there already" cairn simulate corridor --set d1 $small --pictures pictures again.h5
rm 'pictures/d1 run 1.png'
refuses "d1 run 2.png. is there already" cairn simulate corridor --set d1 $small --pictures pictures again.h5
[ ! -e again.h5 ] && [ ! -e 'pictures/d1 run 1.png' ] || die "a simulation that was refused left a file"
[ "$(cat 'pictures/d1 run 2.png')" = mine ] || die "a picture was replaced"
exits 0 cairn simulate corridor --set d1 $small --pictures pictures again.h5 --force
same_bits d1.h5 again.h5
rm again.h5
exits 0 cairn inspect d1.h5
says 'hand-made features +door, door detected$'
says 'label error +0.1 m$'

# Images, which the pipeline makes the same inputs of. A job does not read the truth: nothing else differs.
exits 0 cairn simulate corridor --set d1 $small --images images.h5
exits 0 cairn run image_features images.h5 --out made
exits 1 cairn diff made/image_features.h5 d1.h5
[ "$(grep -c 'truth/run/./.*: only in B$' stdout)" -eq 6 ] || die "other truth: $(cat stdout)"
! grep -E '^  run/|name' stdout || die "the pipeline makes other inputs: $(cat stdout)"

exits 0 cairn evaluate d1.h5 --feature door --json
[ "$(grep -c '"error_reduction":' stdout)" -eq 14 ] || die "not seven windows, soft and sampled: $(cat stdout)"
exits 0 cairn evaluate d1.h5 --feature "door detected" --against door --holdout "d1 run 2"
says '^detection.precision +[0-9.]+%$'
says '^detection.recall +[0-9.]+%, of 160 samples$'
refuses "no feature 'lift'" cairn evaluate d1.h5 --feature lift

# Where is it? By doors, found in the one run by a map of the other.
exits 0 cairn run localization d1.h5 --set runs="d1 run 2" --set features=door --set travelled_m=15 --set traverses=6 --out where
exits 0 cairn evaluate where --truth d1.h5
says '^runs +d1 run 2$'
says 'nothing known at the start$'
exits 0 cairn report where --force
says '^where/report.html$'
grep -q 'SAMPLES.h5' where/report.html || die "the report does not say how to see errors"
exits 0 cairn report where --log d1.h5 --force
for title in 'Error by distance travelled' 'How sure' 'What a robot believes'; do
  grep -q "<h2>$title</h2>" where/report.html || die "the report has no section '$title'"
done
refuses 'made from other samples' cairn report where --log images.h5 --out page.html

# Driven both ways, moved by odometry: which way it faces is found out too.
exits 0 cairn simulate corridor --set d1 --runs 4 --snapshots 80 --length-m 40 --seed 5 --both-ways --odometry both.h5
exits 0 cairn inspect both.h5
says 'd1 run 2 back'
exits 0 cairn run localization both.h5 --set runs="d1 run 3,d1 run 4 back" --set features=door --set heading=unknown \
  --set travelled_m=15 --set traverses=6 --out both
exits 0 cairn evaluate both --truth both.h5
says '^heading +unknown to the robot$'
says 'within_1m  facing$'
exits 0 cairn evaluate both.h5 --feature door --heading-window-deg 90
says 'that face alike make P'
says '90.00 degrees: the robot knows its heading as well$'
refuses 'heading-window-deg' cairn evaluate both.h5 --feature door --heading-window-deg 400
refuses 'heading' cairn run localization both.h5 --set runs="d1 run 3" --set features=door --set heading=perhaps --out no
