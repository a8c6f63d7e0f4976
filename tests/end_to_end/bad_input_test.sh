#!/usr/bin/env bash
# Bad input: a clear message with file and line, or robot and step; exit code 2; nothing half-written.
source "$(dirname "$0")/common.sh"

odometry() { printf 'time_s,robot,turn_rad,forward_m\n'; printf '%s\n' "$@"; }
observations() { printf 'time_s,robot,landmark,range_m,bearing_rad\n'; printf '%s\n' "$@"; }
import() { cairn import csv --odometry odometry.csv --observations observations.csv "$@" log.h5; }
good_rows=('1,a,0,1' '2,a,0,1' '3,a,0,1')

refuses_import() {
  refuses "$@"
  [ ! -e log.h5 ] || die "an import that was refused left a log"
}

# Import: each with its file and line.
odometry >odometry.csv
observations >observations.csv
refuses_import 'odometry.csv' import
odometry "${good_rows[@]}" >odometry.csv
observations '2,b,,,' >observations.csv
refuses_import 'observations.csv:2' import
observations '0.5,a,,,' >observations.csv
refuses_import 'observations.csv:2.*before the first control' import
observations '2,a,,,' '1.5,a,,,' >observations.csv
refuses_import 'observations.csv:3.*backwards' import
observations '2,a,x,nan,0' >observations.csv
refuses_import 'observations.csv:2' import
observations '2,a,x,1' >observations.csv
refuses_import 'observations.csv:2' import
observations '2,a,x,9,0' >observations.csv
refuses_import 'observations.csv:2.*maximum' import --max-range-m 8
refuses_import 'max_range_m: .*allowed: a number above 0' import --max-range-m 0
refuses_import 'field_of_view_rad: 360.*allowed: above 0, up to a full turn' import --field-of-view-rad 360
observations '2,a,x,5,0.7' >observations.csv
refuses_import "observations.csv:2: outside the sensor's field of view: 0.7" import --field-of-view-rad 1.2
odometry '1,a,0,1' '2,a,0,inf' >odometry.csv
observations >observations.csv
refuses_import 'odometry.csv:3' import
odometry '2,a,0,1' '1,a,0,1' >odometry.csv
refuses_import 'odometry.csv:3.*backwards.*--skip-bad skips such lines' import
refuses_import 'nowhere.csv' cairn import csv --odometry nowhere.csv log.h5

# What no other command would take is not written.
printf 'x_m,y_m,a,b\n0,0,0,2\n1e10,1,2,0\n' >costs.csv
refuses_import "costs.csv:3: a number that no robot comes to: x_m is" cairn import errors costs.csv log.h5
odometry "${good_rows[@]}" >odometry.csv
printf 'landmark,x_m,y_m\nx,1e10,0\n' >places.csv
observations '2,a,x,1,0' >observations.csv
refuses_import "places.csv:2: a number that no robot comes to: x_m is" import --truth-landmarks places.csv
odometry '1,a,0,1' '2,a,0,1e10' >odometry.csv
refuses_import "a number that no robot comes to: forward_m is" import --units-are-right

cp odometry.csv kept.csv
refuses "'odometry.csv' is an input" cairn import csv --odometry odometry.csv odometry.csv --force
refuses "'./odometry.csv' is an input" cairn import csv --odometry odometry.csv ./odometry.csv --force
cmp odometry.csv kept.csv || die "an import has overwritten its input"

# What a shell makes of a variable that is not set is no name.
empty=
for command in "map odometry.csv --out" "run landmark_map odometry.csv --out" "map" "inspect" "diff odometry.csv" \
  "simulate loop" "export tum odometry.csv" "evaluate odometry.csv --truth" "report odometry.csv --out" \
  "import csv log.h5 --odometry" "run landmark_map --set"; do
  # shellcheck disable=SC2086
  refuses 'nothing is given \(an empty word\)' cairn $command "$empty"
done
[ ! -e map ] || die "an empty name was taken for another"

# MRCLAM: a folder with a file missing.
mkdir mrclam
refuses_import 'no Barcodes.dat' cairn import mrclam mrclam log.h5
printf '1 5\n6 63\n' >mrclam/Barcodes.dat
refuses_import 'no Robot1_Odometry.dat' cairn import mrclam mrclam log.h5
printf '10 1 0\n12 1 0\n' >mrclam/Robot1_Odometry.dat
refuses_import 'no Robot1_Measurement.dat' cairn import mrclam mrclam log.h5

# A CARMEN log: file and line; skipped and counted on request.
carmen() { printf 'ODOM 0 0 0 0 0 0 1 h 1\n'; printf '%s\n' "$@"; }
good_scan='FLASER 2 1 1 0 0 0 0 0 0 1.5 h 1.5'
carmen "$good_scan" 'BOGUS 1' >carmen.log
refuses_import 'carmen.log:3: unknown message' cairn import carmen carmen.log log.h5
carmen 'FLASER 3 1 1 0 0 0 0 0 0 1.5 h 1.5' >carmen.log
refuses_import 'carmen.log:2: line cut short, or fewer values' cairn import carmen carmen.log log.h5
carmen 'FLASER 2 1 nan 0 0 0 0 0 0 1.5 h 1.5' "$good_scan" >carmen.log
refuses_import 'carmen.log:2: range is not finite: beam 1 measures nan' cairn import carmen carmen.log log.h5
refuses_import 'what is meant is SENSOR=X,Y,DEGREES' cairn import carmen carmen.log log.h5 --mount laser=1,2
refuses_import '--mount is said twice of laser' cairn import carmen carmen.log log.h5 --mount laser=1,2,0 --mount laser=1,2,3
refuses_import 'corrected excludes --raw' cairn import carmen carmen.log log.h5 --corrected --raw
exits 0 cairn import carmen carmen.log log.h5 --skip-bad
says '^cairn: skipped 1: range is not finite$'
says '^log.h5: 1 robot, 2 controls, 0 observations, 1 range scans$'
rm log.h5
gzip -c carmen.log | head -c 40 >cut.log.gz
refuses_import 'cut.log.gz: the gzip stream is damaged or cut short' cairn import carmen cut.log.gz log.h5

# Samples: a file a run, each with its file and line.
vectors() { printf 'time_s,x_m,y_m,red\n'; printf '%s\n' "$@"; }
vectors '1,0,0,5' '2,1,0,6' >monday.csv
vectors '1,0,0,5' '2,1,0,nan' >tuesday.csv
refuses_import 'tuesday.csv:3: not finite' cairn import vectors monday.csv tuesday.csv log.h5
vectors '2,0,0,5' '1,1,0,6' >tuesday.csv
refuses_import 'tuesday.csv:3: time runs backwards' cairn import vectors monday.csv tuesday.csv log.h5
vectors '1,0,0,5' >tuesday.csv
refuses_import 'tuesday.csv:2: a run has two samples or more' cairn import vectors monday.csv tuesday.csv log.h5
refuses_import "OUT.h5 is required: the file to write, whose name ends in .h5" cairn import vectors monday.csv tuesday.csv
ln -s monday.csv monday.h5
refuses "'monday.h5' is an input" cairn import vectors monday.csv monday.h5 --force
rm monday.h5
exits 0 cairn import vectors monday.csv samples.h5
says '^samples.h5: 1 run, 2 samples, 1 input$'
refuses 'samples.h5.* is there already' cairn import vectors monday.csv samples.h5
refuses 'the log: samples.h5: samples, where a log is needed' cairn run landmark_map samples.h5 --out no

# A table of errors.
printf 'x_m,y_m,a,b\n0,0,0,1\n1,0,-1,0\n' >costs.csv
refuses_import 'costs.csv:3: below 0: -1' cairn import errors costs.csv log.h5
printf 'x_m,y_m,a,b\n0,0,0,1\n1,0,1,0\n' >costs.csv
exits 0 cairn import errors costs.csv errors.h5
says '^errors.h5: what it costs to take one of 2 places for another$'
refuses 'errors.h5.* is there already' cairn import errors costs.csv errors.h5

# Images: the line of the table, or the image that it does not name.
mkdir snapshots
for image in a b; do { printf 'P6 10 10 255 ' && head -c 300 /dev/urandom; } >snapshots/$image.ppm; done
poses() { printf 'image,time_s,x_m,y_m\n'; printf '%s\n' "$@"; }
poses a.ppm,1,0,0 >poses.csv
refuses_import 'snapshots/b.ppm: image without a pose' cairn import images snapshots poses.csv log.h5
poses a.ppm,1,0,0 b.ppm,2,1,0 c.ppm,3,2,0 >poses.csv
refuses_import 'poses.csv:4: no such image: snapshots/c.ppm' cairn import images snapshots poses.csv log.h5
printf 'no image' >snapshots/c.ppm
refuses_import 'poses.csv:4: bad image: snapshots/c.ppm: it cannot be decoded' \
  cairn import images snapshots poses.csv log.h5
exits 0 cairn import images snapshots poses.csv images.h5 --skip-bad
says '^images.h5: 1 run, 2 samples, 0 inputs$'
says 'skipped 1: bad image'

# A log with controls only: nothing to map.
odometry "${good_rows[@]}" >odometry.csv
exits 0 cairn import csv --odometry odometry.csv log.h5
refuses 'observation' cairn run landmark_map log.h5 --out controls_only
mv log.h5 controls_only.h5

# Job files.
simulate log.h5
job() { printf '%s\n' "$@" >job.yaml; }
job 'inputs: {log: nowhere.h5}' 'stages:' '  - {name: a, pipeline: landmark_map, log: log}'
refuses "job.yaml:1: input 'log': there is no file 'nowhere.h5'" cairn run job.yaml
job 'inputs: {log: log.h5}' 'stages:' '  - {name: a, pipeline: landmark_map, log: log, options: {ceil_m: 1}}'
refuses "job.yaml:3: unknown option 'ceil_m'.*did you mean 'cell_m'" cairn run job.yaml
job 'inputs: {log: log.h5}' 'stages:' '  - {name: a, pipeline: landmark_map, log: log, options: {cell_m: -1}}'
refuses 'job.yaml:3: cell_m: .*allowed: a number from' cairn run job.yaml
refuses 'unknown option' cairn run landmark_map log.h5 --set ceil_m=1
refuses "no pipeline 'landmarkmap'" cairn run landmarkmap log.h5
refuses "no file 'nowhere.h5'" cairn run landmark_map nowhere.h5
refuses "no command 'rnu'.*did you mean 'run'" cairn rnu
refuses 'wokers' cairn run landmark_map log.h5 --wokers 2
refuses "'.' is no file, but a folder" cairn run landmark_map .
refuses 'job.yaml: cannot make the folder: there is a file where' cairn run landmark_map log.h5 --out job.yaml
refuses "cairn export: there is no 'foo'; known: tum," cairn export foo log.h5 tables

# More memory than allowed: says how much it would need.
refuses 'would need about [0-9.]+ [MG]B.*memory_mb' cairn run landmark_map log.h5 --set memory_mb=1 --out fine
refuses 'would need about [0-9.]+ [MG]B.*memory_mb' cairn run landmark_map log.h5 --set cell_m=0.01 --out fine
[ ! -e fine/landmark_map.h5 ] || die "a run that was refused left a result"

# Evidence that is impossible: exact cells hold no landmark where the first data showed none, and none is false.
refuses "robot 'robot 0', step [0-9]+ \(time [0-9.]+ s\): the evidence is impossible.*observed there: " \
  cairn run landmark_map log.h5 --set model=exact --set growth_start=0.2 --set cell_m=1 --out impossible
[ ! -e impossible/landmark_map.h5 ] || die "a run that was refused left a result"

# A task over a limit on its memory: tried again, then the run fails with the limit's name. No fault of the input.
exits 1 cairn run landmark_map log.h5 --out little --task-memory-mb 1
grep -q 'failed 3 times, last: it would have taken more than 1 MB of memory, .*--task-memory-mb' stderr ||
  die "the limit is not named"
exits 0 cairn run landmark_map log.h5 --out little

# A box too small: the option is named, the task once. A dry run refuses what a run refuses, and leaves nothing.
refuses 'left the box that box_m allows' cairn run landmark_map log.h5 --set box_m=5 --out box
! grep -Eq 'stage .*stage ' stderr || die "the stage is named twice: $(cat stderr)"

# A result where a log is needed; another log's truth; seeds.
exits 0 cairn run landmark_map log.h5 --set iterations=1 --out done
refuses 'done/landmark_map.h5: a landmark_map, where a log is needed' cairn run landmark_map done/landmark_map.h5 --out no
refuses 'a landmark_map, where a log is needed' cairn run landmark_map done/landmark_map.h5 --out no --dry-run
[ ! -e no ] || die "a run that was refused made its folder"
refuses 'seed.*from 0 to 18446744073709551615' cairn simulate loop --seed -1 no.h5
refuses 'seed.*from 0 to 18446744073709551615' cairn simulate loop --seed 18446744073709551616 no.h5
refuses 'set.*d4' cairn simulate corridor --set d4 no.h5
refuses 'snapshots.*0' cairn simulate corridor --snapshots 0 no.h5
refuses 'runs.*0' cairn simulate corridor --runs 0 no.h5
refuses 'length-m.*5' cairn simulate corridor --length-m 5 no.h5
refuses 'label-error-m.*-1' cairn simulate corridor --label-error-m -1 no.h5
refuses 'changed.*2' cairn simulate corridor --changed 2 no.h5
refuses "no folder 'nowhere'" cairn simulate corridor --pictures nowhere no.h5
refuses 'there already' cairn simulate corridor log.h5
refuses 'minutes.*0' cairn simulate office --minutes 0 no.h5
refuses 'minutes.*nan' cairn simulate office --minutes nan no.h5
refuses 'seeds.*0' cairn-reproduce local --seeds 0
[ ! -e no.h5 ] || die "a simulation that was refused left a file"
exits 0 cairn simulate loop --difficulty base --seed 7 another.h5
refuses 'made from another log' cairn evaluate done --truth another.h5
exits 0 cairn evaluate done --truth log.h5

# Nor does a run, of what an earlier one has left, the result that it is made of itself, by whatever name.
ln -s done/landmark_map.h5 link.h5
for poses in done/landmark_map.h5 link.h5; do
  refuses "is an input" cairn run evidence_map log.h5 --input "poses=$poses" --out done --force
done
mkdir own
cp log.h5 own/map.png
refuses "is an input" cairn run landmark_map own/map.png --out own --force
cp log.h5 own/job.yaml
refuses "is an input" cairn map own/job.yaml --out own --force
cmp -s log.h5 own/map.png || die "a log was lost by force"
cmp -s log.h5 own/job.yaml || die "a log was overwritten by a job file"
exits 0 cairn evaluate done --truth log.h5

# Not even by force does a page take the place of what it is made of.
for input in log.h5 done/landmark_map.h5; do
  cp "$input" before.h5
  refuses "'$input' is an input" cairn report done --log log.h5 --out "$input" --force
  cmp -s "$input" before.h5 || die "$input was overwritten"
done

# Places that cannot be written to are the user's choice, for every command that writes.
: >a_file
long=$(printf 'x%.0s' {1..300})
for place in a_file/out /proc/out "$long"; do
  refuses 'a_file|/proc|x{40}' cairn simulate loop "$place"
  refuses 'a_file|/proc|x{40}' cairn export tum done "$place"
  refuses 'a_file|/proc|x{40}' cairn report done --out "$place"
  refuses 'a_file|/proc|x{40}' cairn run landmark_map log.h5 --out "$place"
  refuses 'a_file|/proc|x{40}' cairn keys new desk --dir "$place"
  refuses 'a_file|/proc|x{40}' cairn coordinator --store "$place" --listen "ipc://$work/c.ipc"
  refuses 'a_file|/proc|x{40}' cairn coordinator --store store --listen "ipc://$place/c.ipc"
  CAIRN_HOME=$place refuses 'a_file|/proc|x{40}' cairn coordinator
done
refuses 'a_file' cairn run landmark_map log.h5 --out a_file

# A map to start from that is none, that has no place for it, and none where one is needed.
refuses "the input 'map': no landmark_map" cairn run landmark_map log.h5 --input map=log.h5 --out no_map
refuses 'has no such input.*did you mean .map' cairn run landmark_map log.h5 --input mpa=log.h5
refuses 'write name=FILE' cairn run landmark_map log.h5 --input log.h5
refuses "start=anywhere needs the input 'map'" cairn run landmark_map log.h5 --set start=anywhere --out no_map

# Damaged files.
head -c 3000 log.h5 >cut.h5
refuses 'cut.h5' cairn run landmark_map cut.h5 --out cut
refuses 'cut.h5' cairn inspect cut.h5
printf 'no file of ours' >text.h5
refuses 'text.h5' cairn inspect text.h5
refuses 'text.h5' cairn diff text.h5 log.h5
refuses 'text.h5' cairn evaluate text.h5 --truth log.h5
refuses 'log.h5' cairn evaluate log.h5 --truth log.h5
refuses 'out_of_nowhere' cairn report out_of_nowhere
refuses 'there already' cairn simulate loop log.h5
ln -s nowhere/new.h5 dangling.h5
refuses 'dangling.h5. is there already' cairn simulate loop dangling.h5
[ -L dangling.h5 ] || die "a link that leads nowhere was replaced"
for folder in cut fine controls_only; do
  [ ! -d "$folder" ] || ! find "$folder" -name '*.tmp' | grep -q . || die "a half-written file is left in $folder"
done

# Refused over a network without keys.
refuses 'keys' cairn coordinator --store store --listen tcp://127.0.0.1:17171
! grep -q 'listening on' stderr || die "a coordinator that was refused says that it listens"

# Units: refused with the row and the likely unit, read on request and then not asked about again; another program's log is
# looked at when it is run.
odometry 1,a,0,500 2,a,0,500 3,a,0,500 >odometry.csv
observations 2,a,,, >observations.csv
rm -f log.h5
refuses_import 'odometry.csv:.*it goes 500 m within 1 s.*in millimetres' import
exits 0 import --units-are-right
says 'warning: .*it goes 500 m'
exits 0 cairn inspect log.h5
! grep -q 'in doubt' stdout || die "an insisted log is in doubt"
exits 0 cairn run landmark_map log.h5 --dry-run
rm log.h5

# A folder: what it looks like, and which command reads it.
mkdir tables
odometry "${good_rows[@]}" >tables/odometry.csv
exits 0 cairn inspect tables
says 'cairn import csv --odometry tables/odometry.csv log.h5'
refuses 'looks like a table of odometry; read it in: cairn import csv' cairn inspect tables/odometry.csv
refuses 'cairn inspect tables/odometry.csv. says how it is read in' cairn run landmark_map tables/odometry.csv
refuses 'cairn map tables/odometry.csv. chooses one' cairn run tables/odometry.csv
mkdir nothing
refuses "holds nothing that Cairn knows" cairn inspect nothing

# What is no number is none for a worker either.
exits 2 cairn-worker --connect "ipc://$work/none/hub" --drain-s nan
says "'nan' is not allowed; allowed: a number from 0 to 1e\+06"

# A batch job that Slurm does not take leaves nothing behind.
mkdir slurm
printf '#!/bin/sh\necho "sbatch: error: invalid partition specified: long" >&2\nexit 1\n' >slurm/sbatch
chmod +x slurm/sbatch
simulate log.h5
exits 1 env PATH="$PWD/slurm:$PATH" cairn run landmark_map log.h5 --out map --on slurm --sbatch=--partition=long
says 'invalid partition specified: long'
[ ! -e map ] || die "a job that Slurm did not take has left $(find map)"
# Nor one of which it says no number, or fails after it has said one.
on_slurm() { env PATH="$PWD/slurm:$PATH" cairn run landmark_map log.h5 --out map --on slurm "$@"; }
for answer in 'echo' 'echo queue full' 'echo 123; exit 1'; do
  printf '#!/bin/sh\n%s\n' "$answer" >slurm/sbatch
  exits 1 on_slurm
  [ ! -e map ] || die "a job that Slurm did not take has left $(find map)"
done
# Keys, list of keys and links that somebody has put there.
cat >slurm/sbatch <<'EOF'
#!/bin/sh
cat >script
echo '123;cluster'
EOF
mkdir -p map victim
chmod 755 victim
ln -s ../victim map/.on-slurm
refuses 'map/.on-slurm is there already, and is no folder of your own' on_slurm
[ -z "$(ls victim)" ] && [ "$(stat -c %a victim)" = 755 ] || die "a link was followed: $(ls -la victim)"
rm map/.on-slurm
mkdir -m 755 map/.on-slurm
refuses 'no folder of your own that nobody else may enter' on_slurm
chmod 700 map/.on-slurm
ln -s ../../victim/log map/.on-slurm/log
refuses 'map/.on-slurm/log is a link' on_slurm
rm map/.on-slurm/log
exits 0 cairn keys new client --dir map/.on-slurm
cp map/.on-slurm/client.key known
rm map/.on-slurm/client.pub
printf '%s submitter mine\n' "$(head -c 40 /dev/zero | tr '\0' a)" >map/.on-slurm/allowed
exits 0 on_slurm
says "^submitted as Slurm's job 123; "
! cmp -s known map/.on-slurm/client.key || die "a key that others know is taken"
grep -qF -e "$(cat map/.on-slurm/client.pub)" map/.on-slurm/allowed || die "its own key is not allowed"
! grep -q aaaaaaaa map/.on-slurm/allowed || die "a key that somebody has put there is allowed"
# One that works there is left alone, also while it is queued and has written nothing.
printf '#!/bin/sh\necho 99\necho 123\n' >slurm/squeue
chmod +x slurm/squeue
cp map/.on-slurm/client.key known
refuses "Slurm's job 123 works in .*map already, or will; \`scancel 123\` ends it" on_slurm
cmp -s known map/.on-slurm/client.key || die "the keys of a job that works there were changed"
# So is one that is being submitted, by two at a time or by who was killed over it.
printf '#!/bin/sh\n' >slurm/squeue
cp slurm/sbatch works
cat >slurm/sbatch <<EOF
#!/bin/sh
cp map/.on-slurm/client.key known
$(command -v cairn) run landmark_map log.h5 --out map --on slurm >second 2>&1
kill -9 \$PPID
EOF
exits 137 on_slurm
grep -q 'another `cairn run --on slurm` submits a job that works in .*map' second || die "not refused: $(cat second)"
refuses 'was cut off while it submitted a job .* then remove .*map/.on-slurm/job and say this again' on_slurm
cmp -s known map/.on-slurm/client.key || die "the keys of a job that was submitted were changed"
mv works slurm/sbatch
rm map/.on-slurm/job
exits 0 on_slurm
# What it has started ends with it: the scaler is gone before its workers are cancelled.
cat >slurm/cairn <<'EOF'
#!/bin/sh
case $1 in
scale)
  trap 'echo ended >>order; exit' TERM
  echo scales >>order
  while :; do sleep 0.05; done ;;
submit) echo '{"id": "1-a"}' ;;
coordinator) exec sleep 600 ;;
watch) until [ -e order ]; do sleep 0.05; done ;;
esac
EOF
printf '#!/bin/sh\necho "7 slurm-$NAME-0"\n' >slurm/squeue
printf '#!/bin/sh\necho "cancels $*" >>order\n' >slurm/scancel
printf '#!/bin/sh\necho NodeAddr=127.0.0.1\n' >slurm/scontrol
chmod +x slurm/*
sed -i "s|^cairn=.*|cairn='$PWD/slurm/cairn'|" script
NAME=$(sed -n 's/^name=//p' script)
exits 0 env NAME="$NAME" SLURM_JOB_ID=123 SLURMD_NODENAME=x PATH="$PWD/slurm:$PATH" sh script
[ "$(paste -sd, order)" = 'scales,ended,cancels 7' ] || die "not in this order: $(cat order)"
