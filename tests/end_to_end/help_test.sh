#!/usr/bin/env bash
# Every command has --help with an example that runs as printed, and knows a wrong option when it sees one.
source "$(dirname "$0")/common.sh"

subcommands_in() { awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on && /^  [a-z]/ {print $1}'; }
commands=$(cairn --help | subcommands_in)
[ "$(wc -w <<<"$commands")" -ge 12 ] || die "cairn --help lists too few commands: $commands"
exits 0 cairn help
says '^Subcommands:'
exits 0 cairn help run
says 'cairn run landmark_map'
[ -z "$(sed -n 's/^  cairn run .*--out \([a-z]*\).*/\1/p' stdout | sort | uniq -d)" ] || die "its examples cannot be run in a row"
refuses "there is no option '--ouput'; did you mean '--out'" cairn run landmark_map log.h5 --ouput result
refuses "there is no option '--skip-bed'; did you mean '--skip-bad'" cairn import csv --odometry o.csv --skip-bed log.h5
refuses "(cairn import csv --help lists them)" cairn import csv --odometry o.csv --skip-bed log.h5
refuses "(cairn import csv --help says more)" cairn import csv --odometry o.csv
exits 0 cairn pipelines
says '^landmark_map +log'
exits 0 cairn run landmark_map --help
says '^  cell_m='
says '^      .*from .* to .* m'
refuses "there is no command 'rnu'; did you mean 'run'" cairn help rnu
refuses "export: there is no 'foo'" cairn help export foo
exits 0 cairn help run landmark_map
refuses "there is no pipeline 'landmrk_map'; did you mean 'landmark_map'" cairn run landmrk_map --help
for command in 'cairn --help' 'cairn --version' 'cairn help run' 'cairn run --help' 'cairn-worker --help' \
  'cairn-worker --version' 'cairn-worker --describe' 'cairn page --help' 'cairn-page --version' 'cairn-sim --help' 'cairn-sim --seeds 1'; do
  code=0
  $command >/dev/full 2>stderr || code=$?
  [ "$code" -eq 1 ] || die "exit code $code, not 1, where nothing can be written: $command"
  grep -q '^cairn[a-z-]*: cannot write to the standard output' stderr || die "it does not say why: $command"
done
for command in $commands; do
  exits 0 cairn "$command" --help
  says 'xample'
  [[ $command =~ ^(worker|page)$ ]] || refuses 'no-such-option|required' cairn "$command" --no-such-option
done

# What messages, verdicts and helps tell people to do is there. An option that they name is one of the commands named before it
# (`cairn import csv --range-m`); one by itself, of some command.
options_in() { grep -oE -- '--[a-z][a-z-]*' | sort -u; }
for command in $commands; do
  for words in "$command" $(cairn "$command" --help | subcommands_in | sed "s/^/$command:/"); do
    read -ra split <<<"${words//:/ }"
    cairn "${split[@]}" --help | options_in >"help.$words"
  done
done
for program in cairn-worker cairn-page cairn-reproduce cairn-sim; do
  for words in "$program" $($program --help | subcommands_in | sed "s/^/$program:/"); do
    read -ra split <<<"${words//:/ }"
    "${split[@]}" --help | options_in >"help.$words"
  done
done
# Of the sources' texts, with those that follow one another put together. What is said to other programs, styles and old names are not.
find "$CAIRN_SOURCE"/{schema,pipelines,datasets,coordinator,worker} \( -name '*.cc' -o -name '*.h' \) |
  grep -vE '_test\.|testing|schema/command_line|datasets/report/drawing|datasets/reproduce|scale/engines|on_slurm' |
  xargs -d '\n' sed -z 's,\n *//[^\n]*,,g; s/"[[:space:]]*\n[[:space:]]*"//g' | tr -d '\000' | grep -aoE '"([^"\\]|\\.)*"' >texts
named=0
for of in help.*; do
  words=${of#help.} && words=${words//:/ }
  [ -z "$(compgen -G "$of:*")" ] || continue # what follows is a command of its own
  [[ $words == cairn-* ]] || words="cairn $words"
  while IFS= read -r option; do
    grep -qxF -- "$option" "$of" || die "a message names an option that is not there: $words $option"
    named=$((named + 1))
  done < <(sed 's/--help`: /--help /g; s/\(.\)cairn/\1\ncairn/g' texts | sed -n "s/^$words \([^\`\";]*\).*/\1/p" | sed 's/ \(or\|and\|says\) .*//' | options_in)
done
[ "$named" -ge 40 ] || die "only $named options were named with a command"
cat help.* | sort -u >known.options
grep -aoE '(^"|[ (`'"'"'])--[a-z][a-z-]*' texts | options_in | grep -vxF -f known.options >unknown.options || true
[ ! -s unknown.options ] || die "messages name options that are not there: $(tr '\n' ' ' <unknown.options)"

# Whatever says facts says them for programs, too; those of `keys` and of `scale` are in their commands.
for command in $commands; do
  for words in "$command" $(cairn "$command" --help | subcommands_in | sed "s/^/$command:/"); do
    case $words in
      coordinator | worker | page | scale* | keys* | simulate | import | export) continue ;;
    esac
    read -ra words <<<"${words//:/ }"
    cairn "${words[@]}" --help | grep -q -- '--json' || die "cairn ${words[*]} has no --json"
  done
done

# What the examples speak of.
mkdir inputs
simulate inputs/log.h5
cairn export csv inputs/log.h5 inputs >/dev/null
mkdir inputs/MRCLAM_Dataset6
printf '1 5\n6 63\n' >inputs/MRCLAM_Dataset6/Barcodes.dat
printf '10 1 0\n12 1 0\n' >inputs/MRCLAM_Dataset6/Robot1_Odometry.dat
printf '11 63 1 0\n' >inputs/MRCLAM_Dataset6/Robot1_Measurement.dat
printf 'time_s,x_m,y_m,red\n1,0,0,5\n2,1,0,6\n' | tee inputs/monday.csv | gzip >inputs/tuesday.csv.gz
printf 'ODOM 0 0 0 0 0 0 1 h 1\nFLASER 2 1 2 1 0 0 1 0 0 2 h 2\n' | gzip >inputs/intel.log.gz
printf 'FLASER 3 2 1 2 0 0 0 0 0 0 1 h 1\n' >inputs/scans.log
cairn import carmen inputs/scans.log inputs/scans.h5 >/dev/null
mkdir inputs/run1
printf '1000 0 0 0\n' >inputs/run1/od.txt
printf '1000 1 2 3 4 5 6 7 8\n' >inputs/run1/sonar.txt
{ printf '1000' && printf ' %d' {1..361} && echo; } >inputs/run1/laser.txt
printf 'Odometry 0 0 0\nLaser 2 1 1\n' | gzip >inputs/loop5.log.gz
printf 'O 0 0 0 1\n' | gzip >inputs/robotdata1.log.gz
mkdir inputs/trajectories
printf '1 0 0 0 0 0 0 1\n' >inputs/trajectories/robot.tum
echo '1 0 0 0 0 1 0 0 0 0 1 0' >inputs/00.txt
echo 0 >inputs/times.txt
echo '1000,0,0,0,1,0,0,0' >inputs/data.csv
echo 'EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1' >inputs/graph.g2o
mkdir inputs/snapshots
for image in a b; do { printf 'P6 10 10 255 ' && head -c 300 /dev/urandom; } >inputs/snapshots/$image.ppm; done
printf 'image,time_s,x_m,y_m\na.ppm,1,0,0\nb.ppm,2,1,0\n' >inputs/poses.csv
printf 'x_m,y_m,lobby,lift\n0,0,0,2\n3,0,2,0\n' >inputs/costs.csv
printf '%s\n' 'name: museum' 'inputs: {log: log.h5}' 'stages:' '  - {name: landmarks, pipeline: landmark_map, log: log}' \
  >inputs/job.yaml
cairn run landmark_map inputs/log.h5 --out inputs/result >/dev/null 2>&1
for name in desk ann; do cairn keys new "$name" --dir inputs >/dev/null; done
mkdir inputs/logs
cp inputs/log.h5 inputs/logs/monday.h5
cp -r inputs/result inputs/one-worker
cp -r inputs/result inputs/five-workers

# runs COMMAND…: its example, as printed, each line in a folder that holds what it reads and not what it writes.
runs() {
  local line
  [ -n "$(example "$@")" ] || die "cairn $*: no example"
  known["cairn $*"]=run
  while IFS= read -r line; do
    line=$(sed "s/--until [0-9-]*/--until $(date -u -d '+1 year' +%F)/" <<<"$line") # an example's date is over one day
    rm -rf here
    cp -r inputs here
    [[ ! $line =~ simulate\ loop|import\ (csv|g2o) ]] || rm here/log.h5
    [[ ! $line =~ --out\ result ]] || rm -r here/result
    (cd here && bash -euo pipefail -c "$line") </dev/null >stdout 2>stderr || die "the example of cairn $* fails: $line"
    ran=$((ran + 1))
  done < <(example "$@")
}
ran=0
declare -A known=() # commands whose examples were run, or are by another test

runs
for command in run map simulate 'simulate loop' 'simulate corridor' 'simulate hallway' 'simulate narrow-doors' 'simulate smooth-wall' 'simulate office' import 'import csv' 'import mrclam' 'import vectors' 'import images' 'import errors' 'import carmen' 'import pioneer' 'import dpslam' 'import wean' 'import tum' 'import kitti' 'import euroc' 'import g2o' inspect evaluate report pipelines export \
  'export tum' 'export kitti' 'export euroc' 'export g2o' 'export mcap' 'export geojson' 'export ply' 'export ros' 'export octomap' 'export png' 'export csv' landmarks diff keys 'keys allow' 'keys show' 'keys revoke'; do
  read -ra words <<<"$command"
  runs "${words[@]}"
done

# Those of the pipelines, as far as --dry-run goes: files and options are read, and each is begun.
mkdir pipelines
cd pipelines
cairn simulate loop --difficulty paper --sonar --seed 7 log.h5 >/dev/null
cairn export csv log.h5 tables >/dev/null
cairn import images ../inputs/snapshots ../inputs/poses.csv images.h5 >/dev/null
for run in 1 2; do
  awk -v run="$run" 'BEGIN {
    print "time_s,x_m,y_m,door,light"
    for (k = 0; k < 40; ++k) printf "%d,%g,0,%g,%g\n", k, k / 2, sin(k + run / 50), cos(k / 3 + run / 50)
  }' >run$run.csv
done
cairn import vectors run1.csv first.h5 >/dev/null
cairn import vectors run1.csv run2.csv vectors.h5 >/dev/null
cairn run landmark_learning first.h5 --set networks=2 --set steps=5 --set window_m=5 --out learned >/dev/null 2>&1
cp learned/landmark_learning.h5 networks.h5
shown=0
for pipeline in $(cairn pipelines --json | sed -n 's/^    "name": "\(.*\)",$/\1/p'); do
  cp vectors.h5 samples.h5
  [ "$pipeline" != image_features ] || cp images.h5 samples.h5
  line=$(cairn pipelines "$pipeline" | sed -n 's/^  \(cairn run .*--out result\)$/\1/p')
  [ -n "$line" ] || die "cairn pipelines $pipeline: no example"
  [[ ! "$line " =~ =0(\.0*)?\  ]] || die "its example says nothing of what an option takes: $line"
  exits 0 bash -euo pipefail -c "$line --dry-run"
  shown=$((shown + 1))
done
[ "$shown" -ge 7 ] || die "only $shown pipelines were found"
cd ..

exits 0 cairn-reproduce help
says '^Subcommands:'
refuses "there is no command 'landmark'; did you mean 'landmarks'" cairn-reproduce landmark
# The papers' figures take minutes of processor time: each has a test of its own, which runs its example.
for figures in $(cairn-reproduce --help | subcommands_in); do
  grep -qF "(cairn-reproduce $figures --help | examples_in)" "$CAIRN_SOURCE"/tests/end_to_end/reproduce*_test.sh ||
    die "no test runs the example of cairn-reproduce $figures"
done

# Those of the service: a job is submitted, paused, gone on with and cancelled before there is a worker; a second one is
# computed.
for home in idle service; do
  (CAIRN_HOME=$work/$home exec cairn coordinator) 2>$home.log &
  until_true 10 grep -q 'listening' $home.log
done
export CAIRN_HOME=$work/idle
for command in submit list status pause resume priority cancel delete clean; do runs "$command"; done
export CAIRN_HOME=$work/service
runs submit
cairn worker 2>worker.log &
runs watch
runs logs
runs results

# The service as its own help shows it, from nothing.
export CAIRN_HOME=$work/another
lines=$(example coordinator)
(cd inputs && bash -c "$lines"$'\n''code=$?; kill $(jobs -p); exit $code') >stdout 2>stderr ||
  die "the example of cairn coordinator fails: $lines"
says 'done|landmarks'
known["cairn coordinator"]=run
[ "$ran" -ge 20 ] || die "only $ran examples were run"

# What is left needs hosts, a cluster, a mount or a worker's number: it is read to its end, as far as the address of a service,
# which nothing can have.
export CAIRN_HOME=$work/$(printf 'x%.0s' {1..200})
# reads WHAT LINES: the commands of an example, each by itself.
reads() {
  local line part
  while IFS= read -r line; do
    while IFS= read -r part; do
      (cd inputs && bash -c "$part") </dev/null >stdout 2>stderr || [ $? -le 2 ] || die "the example of $1 ends badly: $part"
      ! grep -E '\(cairn.* --help (lists|says)|Run with --help' stderr || die "the example of $1 says what there is not: $part"
      parsed=$((parsed + 1))
    done < <(sed 's/ && /\n/g; s|/mnt/safe|safe|g' <<<"$line")
  done <<<"$2"
}
parsed=0
for command in $commands; do
  for words in "$command" $(cairn "$command" --help | subcommands_in | sed "s/^/$command:/"); do
    read -ra words <<<"${words//:/ }"
    [ -z "${known["cairn ${words[*]}"]:-}" ] || continue
    lines=$(example "${words[@]}")
    [ -n "$lines" ] || die "cairn ${words[*]}: no example"
    reads "cairn ${words[*]}" "$lines"
  done
done
reads cairn-worker "$(cairn-worker --help | examples_in)"
reads cairn-page "$(cairn-page --help | examples_in)"
[ "$parsed" -ge 12 ] || die "only $parsed other examples were read"
