#!/usr/bin/env bash
# The test of the test: plants bugs in a copy of the sources, one at a time, and shows that cairn-sim finds each.
#
#   tests/simulation/find_bugs.sh [--seeds N] [--scratch DIR] [--applies] [PATCH…]
#
#   --seeds N      give up on a bug after so many worlds (10000)
#   --scratch DIR  where the copy and its build lie (build/planted); kept, so that the next time is quick
#   --applies      only say whether every patch still applies
#   PATCH…         only these (tests/simulation/bugs/*.patch)
#
# Prints for each bug the first seed that finds it and what was wrong there. Exit code 1: one was not found, or does
# not apply, or the sources without a bug fail.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
seeds=10000 scratch=$root/build/planted applies=false patches=()
while [ $# -gt 0 ]; do
  case $1 in
    --seeds) seeds=$2; shift ;;
    --scratch) scratch=$2; shift ;;
    --applies) applies=true ;;
    -h | --help) sed -n '2,13s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "unknown option $1" >&2; exit 2 ;;
    *) patches+=("$(realpath "$1")") ;;
  esac
  shift
done
command -v patch >/dev/null || { echo "needs patch: apt-get install patch" >&2; exit 2; }
[ ${#patches[@]} -gt 0 ] || patches=("$root"/tests/simulation/bugs/*.patch)

copy=$scratch/sources build=$scratch/build sim=$scratch/build/bin/cairn-sim
mkdir -p "$copy" "$build"
# Only what changed, so that what was built stays built.
renew() { cmp -s "$root/$1" "$copy/$1" || install -D "$root/$1" "$copy/$1"; }
(cd "$root" && find cmake schema coordinator deploy/kubernetes tests/simulation -type f) | while read -r file; do renew "$file"; done
# The core, the simulator, and nothing else.
cat >"$copy/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(cairn VERSION 0.1.0 LANGUAGES C CXX)
list(APPEND CMAKE_MODULE_PATH ${CMAKE_SOURCE_DIR}/cmake)
include(CairnBuild)
include(CairnDependencies)
include(GNUInstallDirs)
include(CairnTargets)
add_subdirectory(schema)
add_subdirectory(coordinator)
add_subdirectory(tests/simulation)
END

broken=0
plant() { patch --directory "$copy" --strip 1 --fuzz 0 --quiet --no-backup-if-mismatch --reject-file - "$@" >/dev/null; }
say() { printf '%-36s %s\n' "$1" "$2"; }
compile() { cmake --build "$build" --target cairn-sim >"$scratch/build.log" 2>&1; }

if ! $applies; then
  cmake -S "$copy" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF >"$scratch/build.log" 2>&1
  compile || { cat "$scratch/build.log" >&2; exit 1; }
  if found=$("$sim" --seeds "$seeds" --stop 2>/dev/null); then
    say "(no bug)" "not one of $seeds worlds fails"
  else
    say "(no bug)" "FAILS: $found"
    exit 1
  fi
fi
for patch in "${patches[@]}"; do
  name=$(basename "$patch" .patch)
  if ! plant --dry-run <"$patch"; then
    say "$name" "DOES NOT APPLY"
    broken=1
    continue
  fi
  $applies && { say "$name" "applies"; continue; }
  plant <"$patch"
  if ! compile; then
    say "$name" "DOES NOT COMPILE: $(grep -m 1 error "$scratch/build.log")"
    broken=1
  elif found=$("$sim" --seeds "$seeds" --stop 2>/dev/null); then
    say "$name" "NOT FOUND in $seeds worlds"
    broken=1
  else
    say "$name" "$(grep -m 1 '^seed' <<<"$found" | cut -c 1-160)"
  fi
  sed -n 's|^+++ b/||p' "$patch" | while read -r file; do renew "$file"; done
done
exit $broken
