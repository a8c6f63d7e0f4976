#!/usr/bin/env bash
# From a fresh clone to a map: installs what is missing, builds, makes a log, maps it.
#
#   deploy/quickstart.sh                 a log of real robots where CAIRN_DATA names a folder that holds MRCLAM,
#                                        else a simulated one: 4 robots, 25 m of odometric error
#   deploy/quickstart.sh --log FILE.h5   your own log (see docs/my-own-log.md)
#
#   --out DIR      where the results go (default: out/quickstart)
#   --workers N    how many workers (default: one a core)
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

log= out= workers=$(nproc)
while [ $# -gt 0 ]; do
  case $1 in
    --log | --out | --workers) [ $# -gt 1 ] || fail "$1 needs a value" ;;&
    --log) log=$(realpath -e -- "$2") || fail "there is no log '$2'"; shift 2 ;;
    --out) out=$(realpath -m -- "$2"); shift 2 ;;
    --workers) workers=$2; shift 2 ;;
    -h | --help) sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$1'; allowed: --log FILE, --out DIR, --workers N" ;;
  esac
done
[ -z "${CAIRN_DATA:-}" ] || CAIRN_DATA=$(realpath -m -- "$CAIRN_DATA")
cd "$root"
out=${out:-out/quickstart}
cairn=build/release/bin/cairn

deploy/install.sh
say "building"
deploy/build.sh release cairn cairn-worker cairn-page cairn-images

name=mine
if [ -z "$log" ]; then
  mkdir -p "$out"
  if [ -n "${CAIRN_DATA:-}" ] && [ -d "$CAIRN_DATA/mrclam6" ]; then
    name=mrclam6
    log=$out/$name.h5
    say "importing MRCLAM 6: five real robots, fifteen landmarks (CAIRN_DATA)"
    [ -e "$log" ] || "$cairn" import mrclam "$CAIRN_DATA/mrclam6" "$log"
  else
    name=loop
    log=$out/$name.h5
    say "simulating four robots in a building with a loop"
    [ -e "$log" ] || "$cairn" simulate loop --difficulty base --robots 4 --seed 1 "$log"
  fi
fi
say "mapping $log"
exec "$cairn" map "$log" --out "$out/$name" --workers "$workers"
