#!/usr/bin/env bash
# Files of strangers and of other programs: nothing in them reaches the terminal as it is, nobody waits for ever, no
# damage is taken for data, and no file of the user's own is lost.
source "$(dirname "$0")/common.sh"
export LC_ALL=C.UTF-8

# plain: what the last command has said holds newlines, tabs and UTF-8 that can be seen, and nothing else.
plain() {
  local file
  for file in stdout stderr; do
    ! LC_ALL=C grep -qP '[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]|\xe2\x80[\xaa-\xae]' "$file" ||
      die "$1 sends a terminal what it obeys: $(cat -v "$file" | head -5)"
    iconv -f UTF-8 -t UTF-8 "$file" >/dev/null 2>&1 || die "$1 says what is no UTF-8"
  done
}

# any COMMAND…: ends within a minute, with 0, 1 or 2, and says nothing but what is plain.
any() {
  local code=0
  timeout 60 "$@" >stdout 2>stderr || code=$?
  [ "$code" -le 2 ] || die "exit code $code: $*"
  plain "$*"
}

simulate log.h5
exits 0 cairn run landmark_map log.h5 --set iterations=1 --out result
"$CAIRN_BUILD/tests/end_to_end/foreign_files" log.h5 result/landmark_map.h5 strange

# Names that are none are refused by all that read the file; and whatever is said of them is plain.
for file in strange/*-robot-*.h5 strange/*-dataset-*.h5 strange/*-kind-*.h5 strange/*-text-*.h5; do
  any cairn inspect "$file"
  [ ! -s stdout ] || die "inspect takes in the names of $file"
done
for k in 0 1; do
  for command in 'inspect --json' 'evaluate --truth log.h5' 'report --out page.html' 'run landmark_map --dry-run' \
    'diff log.h5' 'export csv' 'export tum' 'export g2o' 'export ros' 'export octomap' 'export png'; do
    # shellcheck disable=SC2086
    set -- $command
    for what in "strange/log-robot-$k.h5" "strange/result-robot-$k.h5"; do
      case $1 in
        export) any cairn export "$2" "$what" exported ;;
        diff) any cairn diff "$what" log.h5 ;;
        run) any cairn run landmark_map "$what" --dry-run ;;
        *) any cairn "$1" "$what" "${@:2}" ;;
      esac
      [ ! -e exported ] && [ ! -e page.html ] || die "$command made something of $what"
    done
  done
  refuses 'robots.* (is not UTF-8|has control characters)' cairn run landmark_map "strange/log-robot-$k.h5"
done

# Tables, and names of files and options.
printf 'time_s,robot,turn_rad,forward_m\n1,\x1b[2Ja,0,1\n2,\x1b[2Ja,0,1\n' >escape.csv
refuses 'has control characters' cairn import csv --odometry escape.csv escape.h5
printf 'time_s,robot,turn_rad,forward_m\n1,R\xf6sa,0,1\n2,R\xf6sa,0,1\n' >latin.csv
refuses 'is not UTF-8' cairn import csv --odometry latin.csv latin.h5
printf 'time_s,robot,turn_rad,forward_m\n1,a,\x1b[2J\xff,1\n' >number.csv
refuses 'number.csv:2: not a number' cairn import csv --odometry number.csv number.h5
plain 'import csv'
printf 'time_s,robot,turn_rad,forward_m\n1,a,0\0x,1\n' >number.csv
refuses "number.csv:2: not a number: turn_rad is '0.u0000x'.*--skip-bad skips such lines" \
  cairn import csv --odometry number.csv number.h5
plain 'import csv'
cp log.h5 $'bad\x1b[2J\xff.h5'
any cairn inspect $'bad\x1b[2J\xff.h5'
any cairn inspect $'none\x1b[2J\xff.h5'
any cairn $'in\x1b[2Jspect'
any cairn run landmark_map $'bad\x1b[2J\xff.h5' --dry-run
refuses 'is not UTF-8' cairn submit landmark_map log.h5 --set $'noise_model=\xff'
refuses "set: noise_model|is not UTF-8|noise_model" cairn run landmark_map log.h5 --set $'noise_model=\xff'
plain run
printf 'name: "a\\e[2J"\nseed: 7\ninputs: {log: log.h5}\nstages:\n  - {name: m, pipeline: landmark_map, log: log}\n' >job.yaml
refuses "job.yaml:1: name: .*is no name" cairn run job.yaml --dry-run

# A FIFO, a folder, a device: at once, and with a sentence.
mkfifo fifo.h5
for file in fifo.h5 /dev/zero; do
  for command in "inspect $file" "diff $file log.h5" "evaluate $file --truth log.h5" "report $file --out page.html" \
    "export csv $file exported" "run landmark_map $file" "import csv --odometry $file out.h5"; do
    code=0
    # shellcheck disable=SC2086
    timeout 60 cairn $command >stdout 2>stderr || code=$?
    [ "$code" -eq 2 ] || die "exit code $code: cairn $command"
  done
done

refuses 'fifo.h5: is a FIFO, which is not read' cairn report fifo.h5 --out page.html
refuses 'fifo.h5: is a FIFO, which is not read' cairn export tum fifo.h5 exported
refuses 'fifo.h5: is a FIFO, which is not read' cairn evaluate fifo.h5 --truth log.h5
refuses 'fifo.h5. is a device, a pipe or a socket' cairn simulate loop --seed 1 fifo.h5 --force
refuses 'fifo.h5. is a device, a pipe or a socket' cairn report result --out fifo.h5 --force
[ -p fifo.h5 ] || die "a file was put in a pipe's place"

# A 0 that turned into a -1, which Fletcher-32 takes for the same.
for command in 'inspect' 'evaluate --truth log.h5' 'report --out page.html' 'diff result/landmark_map.h5'; do
  # shellcheck disable=SC2086
  set -- $command
  refuses 'flipped.h5: (damaged|dataset)' cairn "$1" strange/flipped.h5 "${@:2}"
done
refuses 'flipped.h5: (damaged|dataset)' cairn export tum strange/flipped.h5 exported

# Changed by another program: said by all; what would be taken for Cairn's figures is refused, unless somebody insists.
exits 0 cairn inspect strange/changed.h5
says '^CHANGED by another program'
says '^cairn: warning: another program has changed strange/changed.h5'
exits 0 cairn inspect strange/changed.h5 --json
says '"changed": true'
exits 0 cairn diff strange/changed.h5 result/landmark_map.h5
says 'warning: another program has changed'
for command in 'evaluate strange/changed.h5 --truth log.h5' 'report strange/changed.h5 --out page.html' \
  'export tum strange/changed.h5 exported'; do
  # shellcheck disable=SC2086
  refuses 'another program has changed it.*--changed' cairn $command
  # shellcheck disable=SC2086
  exits 0 cairn $command --changed
  says 'warning: another program has changed'
done
exits 0 cairn run landmark_map strange/changed-log.h5 --dry-run
says 'warning: another program has changed strange/changed-log.h5'
if /usr/bin/python3 -c 'import h5py' 2>/dev/null; then
  cp result/landmark_map.h5 edited.h5
  /usr/bin/python3 -c 'import h5py
with h5py.File("edited.h5", "r+") as f: f["robot/0/observations/map_landmark"][0] = -1'
  refuses 'another program has changed it' cairn evaluate edited.h5 --truth log.h5
  # An array of another length: seen by whoever reads it.
  /usr/bin/python3 -c 'import h5py
with h5py.File("edited.h5", "r+") as f:
  del f["robot/0/poses/x_m"]
  f["robot/0/poses/x_m"] = [1.0]'
  exits 2 cairn inspect edited.h5
  says "^WRONG: 'robot/0/poses/.*where .* is needed"
  says "^cairn: edited.h5: 'robot/0/poses/"
  exits 2 cairn export tum edited.h5 exported --changed
  says "^cairn: edited.h5: 'robot/0/poses/"
fi

# A table that lacks a column: what is left of it is not all that there is.
for command in 'inspect strange/column.h5' 'export csv strange/column.h5 columns' 'run landmark_map strange/column.h5'; do
  # shellcheck disable=SC2086
  refuses "there is no 'robot/0/odometry/forward_m', which 'robot/0/odometry/time_s' needs" cairn $command
done
[ ! -e columns ] || die "cairn export made tables of a log without its distances"

# A gzip bomb is stopped while it is unpacked.
{
  printf 'time_s,robot,turn_rad,forward_m\n'
  awk 'BEGIN {for (i = 0; i < 400000; ++i) print "1,a,0,1"}'
} | gzip -9 >bomb.csv.gz
refuses 'bomb.csv.gz: more than 2 MB of text' cairn import csv --odometry bomb.csv.gz bomb.h5 --max-text-mb 2
head -c 3000000 /dev/zero | tr '\0' '1' | gzip -9 >line.csv.gz
refuses 'line.csv.gz: a line of more than 1 MB' cairn import csv --odometry line.csv.gz bomb.h5 --max-text-mb 64

# Another file under the result's name is not the finished result.
cp -r result taken
cp strange/changed.h5 taken/landmark_map.h5
again() { cairn run landmark_map log.h5 --set iterations=1 --out "$1"; }
exits 0 again result
says 'finished already'
refuses 'force' again taken
cp log.h5 taken/landmark_map.h5
refuses 'landmark_map.h5 is not what it computed' again taken

# Pictures and pages of the user's own.
printf 'mine' >result/map.png
refuses "result/map.png' is there already" again result
[ "$(cat result/map.png)" = mine ] || die "the user's picture was replaced"
mkdir own && printf 'mine' >own/report.html
refuses "own/report.html' is there already" again own
[ "$(ls own)" = report.html ] || die "a run that was refused left something"
mkdir study && printf 'mine' >study/index.html
refuses "'study' holds files of something else" cairn-reproduce landmarks --out study
[ "$(cat study/index.html)" = mine ] || die "the user's page was replaced"
