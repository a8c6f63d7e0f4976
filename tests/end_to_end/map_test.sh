#!/usr/bin/env bash
# The front door: a log in, the pipelines that it asks for, one page; the job file is there to be kept, changed and run again.
# Where CAIRN_DATA is set, the Intel Research Lab's raw odometry and laser too.
source "$(dirname "$0")/common.sh"

cairn simulate loop --difficulty paper --seed 7 landmarks.h5 >/dev/null
exits 0 cairn map landmarks.h5 --out landmarks
[ -s landmarks/landmarks.h5 ] && [ -s landmarks/report.html ] && [ -s landmarks/map.png ] || die "not all there: $(ls landmarks)"
grep -q '^# landmarks: landmark_map, of [0-9]* observations by 1 robot; none says which landmark it is of$' landmarks/job.yaml || die "$(cat landmarks/job.yaml)"
exits 0 cairn map landmarks.h5 --out landmarks
says "finished already"

# The file alone makes the same bits, as does a copy of it made by --dry-run.
exits 0 cairn run landmarks/job.yaml --out by_file
same_bits landmarks/landmarks.h5 by_file/landmarks.h5
cairn map landmarks.h5 --dry-run >job.yaml 2>/dev/null || die "--dry-run fails"
[ ! -e map ] || die "--dry-run left something"
exits 0 cairn run job.yaml --out by_copy
same_bits landmarks/landmarks.h5 by_copy/landmarks.h5

# It does not pass for that of another job which takes their place.
cp -r landmarks replaced
exits 0 cairn run landmark_map landmarks.h5 --set starts=1 --out replaced --force
grep -q "note: 'replaced/job.yaml' is of what was there before" stderr || die "nothing is said of job.yaml: $(cat stderr)"

# What a person has changed stays.
sed -i 's/^seed: .*/seed: 9/' landmarks/job.yaml
refuses 'says something else' cairn map landmarks.h5 --out landmarks
grep -q '^seed: 9' landmarks/job.yaml || die "the job file was replaced"

# Ranges: a path by walls, and a grid of it.
cairn simulate office --seed 21 --minutes 2 ranges.h5 >/dev/null
exits 0 cairn map ranges.h5 --out ranges --json
[ -s ranges/path.h5 ] && [ -s ranges/grid.h5 ] || die "not all there: $(ls ranges)"
exits 0 cairn evaluate ranges/grid.h5 --truth ranges.h5

# Both.
cairn simulate loop --difficulty paper --sonar --seed 7 both.h5 >/dev/null
exits 0 cairn map both.h5 --out both
for stage in landmarks path grid; do [ -s "both/$stage.h5" ] || die "no $stage: $(ls both)"; done

# The log that was named is the one that is mapped, whatever links lead to it and to the folder; not even --force puts a
# result in its place; a name that no job file can hold is refused before anything is computed.
mkdir -p linked/elsewhere/out linked/user
cp landmarks.h5 linked/user/log.h5
cairn simulate loop --difficulty paper --seed 8 linked/elsewhere/log.h5 >/dev/null
ln -s ../elsewhere/out linked/user/link
(cd linked/user && cairn map log.h5 --out link >/dev/null 2>&1) || die "a folder behind a link"
same_bits landmarks/landmarks.h5 linked/elsewhere/out/landmarks.h5
mkdir -p dots/a dots/z/deep
cp landmarks.h5 dots/z/log.h5
ln -s ../z/deep dots/a/link
cairn map dots/a/link/../log.h5 --dry-run | grep -q 'dots/z/log.h5' || die "another log than the one that was named"
mkdir place
cp landmarks.h5 place/landmarks.h5
refuses "the result of stage 'landmarks' would take its place" cairn map place/landmarks.h5 --out place --force
cmp -s landmarks.h5 place/landmarks.h5 || die "a log was replaced"
cp landmarks.h5 $'not utf-8 \xff.h5'
refuses 'cannot stand in a job file' cairn map $'not utf-8 \xff.h5' --out none

# What is no log of Cairn's.
printf 'time_s,turn_rad,forward_m\n1,0,1\n' >own.csv
refuses 'first make a log of it: cairn import csv' cairn map own.csv --out none
refuses "there is no file 'nothing.h5'" cairn map nothing.h5 --out none
refuses 'landmark_map, where a log is needed' cairn map landmarks/landmarks.h5 --out none
[ ! -e none ] || die "something was left behind: $(ls none)"

[ -n "${CAIRN_DATA:-}" ] || { printf 'CAIRN_DATA is unset: real logs skipped\n'; exit 0; }
intel=$CAIRN_DATA/carmen-intel
cairn import carmen "$intel/intel-raw.log.gz" intel.h5 >/dev/null 2>&1
exits 0 cairn map intel.h5 --out intel
exits 0 cairn evaluate intel/path.h5 --relations "$intel/intel.relations.gz" --json
awk -v off="$(number translation_m stdout)" 'BEGIN {exit !(off < 0.3)}' || die "Intel by relations: $(cat stdout)"
