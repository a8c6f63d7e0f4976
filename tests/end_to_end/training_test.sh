#!/usr/bin/env bash
# landmark_learning: a finished run is continued, and says where it comes from; bad input is named by file, run and row,
# exit code 2, and nothing is written.
source "$(dirname "$0")/common.sh"

# A corridor of 40 m, a sample each half metre: two inputs that repeat, one that is noise. corridor SEED [ROWS]
corridor() {
  awk -v seed="$1" -v rows="${2:-80}" 'BEGIN {
    srand(seed)
    print "time_s,x_m,y_m,door,light,noise"
    for (k = 0; k < rows; ++k) {
      x = 0.5 * k + 0.1 * rand()
      printf "%d,%.4f,%.4f,%.4f,%.4f,%.4f\n", k, x, 0.02 * rand(), sin(1.3 * x) + sin(0.41 * x) + 0.2 * rand(),
        cos(0.9 * x) + 0.2 * rand(), rand()
    }
  }'
}
for run in 1 2 3; do corridor $run >run$run.csv; done
exits 0 cairn import vectors run1.csv run2.csv samples.h5
exits 0 cairn import vectors run1.csv run2.csv run3.csv more.h5
train() { cairn run landmark_learning "$@" --set networks=2 --workers 2; }

# Continued: more steps, then more data, another window, another rate. The ancestry names both, the first run first.
exits 0 train samples.h5 --set steps=40 --set init_width=0.5 --out first
exits 0 train samples.h5 --set steps=40 --input weights=first/landmark_learning.h5 --out second
exits 0 train more.h5 --set steps=10 --set window_m=5 --set rate=0.001 \
  --input weights=second/landmark_learning.h5 --out third
exits 0 cairn inspect third/landmark_learning.h5
says 'ancestry/hash +text +\[2\]'
says 'ancestry/options +text +\[2\]'
says 'ancestry/steps +int64 +\[2\] +40, 40'

exits 0 cairn report third --force
says '^third/report.html$'
for title in Training 'What the networks see' Time 'Before this run'; do
  grep -q "<h2>$title</h2>" third/report.html || die "the report has no section '$title'"
done
refuses 'networks are not made from a log' cairn report third --log samples.h5 --out page.html

# Two hidden layers: learned, continued, scored, localised by, reported.
exits 0 train samples.h5 --set steps=20 --set init_width=0.5 --set hidden_2=4 --out deep
exits 0 train samples.h5 --set steps=5 --set hidden_2=4 --input weights=deep/landmark_learning.h5 --out deeper
exits 0 cairn inspect deeper/landmark_learning.h5
says 'networks/hidden_2_weight +float64 +\[2,4,6\]'
exits 0 cairn evaluate deeper --truth more.h5 --json
exits 0 cairn run localization more.h5 --input networks=deeper/landmark_learning.h5 --set traverses=2 --set travelled_m=3 --out found
grep -q '<b>6 + 4</b>' deeper/report.html || die "the report does not say how large the hidden layers are"
refuses "2 networks of 6 and 4 hidden units over 3 inputs, where .* 2 networks of 6 hidden" \
  train samples.h5 --input weights=deep/landmark_learning.h5 --out no

# Several starts side by side; and by a table of errors.
exits 0 train samples.h5 --set steps=20 --set starts=3 --set start_steps=5 --set init_width=2 --out tried
exits 0 cairn inspect tried/landmark_learning.h5
says 'starts/error_m +float64 +\[3\]'
grep -q 'of 3</b><span>start' tried/report.html || die "the report does not say which start went on"
refuses "starts begin with random weights" \
  train samples.h5 --set starts=3 --input weights=first/landmark_learning.h5 --out no
printf 'x_m,y_m,left,middle,right\n0,0,0,1,4\n20,0,1,0,1\n40,0,4,1,0\n' >costs.csv
exits 0 cairn import errors costs.csv costs.h5
exits 0 train samples.h5 --set steps=5 --set window_m=0 --set error=table --input errors=costs.h5 --out by_table

# Weights of another shape, or none at all.
refuses "2 networks of 6 hidden units over 3 inputs, where .* 3 networks of 6" \
  cairn run landmark_learning samples.h5 --set networks=3 --input weights=first/landmark_learning.h5 --out no
refuses "the input 'weights': no networks in it" \
  cairn run landmark_learning samples.h5 --input weights=samples.h5 --out no
refuses "there is no file 'nowhere.h5'" \
  cairn run landmark_learning samples.h5 --input weights=nowhere.h5 --out no

# Options.
refuses 'networks=0: .*allowed: a whole number from 1 to 12' train samples.h5 --set networks=0 --out no
refuses 'networks=40: .*allowed: a whole number from 1 to 12' cairn run landmark_learning samples.h5 --set networks=40 --out no
refuses 'window_m = 1e-05 m reaches no other position from any of the 160 samples' \
  train samples.h5 --set window_m=0.00001 --out no
refuses "holdout: there is no run 'run9'" train samples.h5 --set holdout=run9 --out no
refuses "batch does not go with method=pseudo" train samples.h5 --set method=pseudo --set batch=64 --out no

# Samples; those that an import refuses are a unit test's.
corridor 1 1 >short.csv
refuses 'short.csv:2: a run has two samples or more' cairn import vectors run1.csv short.csv short.h5
[ ! -e no/landmark_learning.h5 ] || die "a run that was refused left a result"
