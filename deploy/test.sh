#!/usr/bin/env bash
# Installs what is missing, builds, and runs the tests; ctest's summary comes last.
#
#   deploy/test.sh          the release tests
#   deploy/test.sh --all    also the format check, clang-tidy on what changed, the core's unit tests under
#                           ASan + UBSan, worker and coordinator under TSan, benchmarks and studies built, what
#                           depends on optional packages without them, and the longer end-to-end tests;
#                           warnings are errors
#
# Tests on real logs look for them in the folder that CAIRN_DATA names, and are skipped without it.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

all=false
for argument in "$@"; do
  case $argument in
    --all) all=true ;;
    -h | --help) sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$argument'; allowed: --all" ;;
  esac
done

# gtest's own skips are fine; a tree without a single test is not. Twice as many at a time as there are cores, for
# many wait.
options=(--output-on-failure --no-tests=error --parallel $(($(cairn_jobs) * 2)))
if ! $all; then
  deploy/install.sh
  say "building (release)"
  deploy/build.sh release
  exec ctest --test-dir build/release "${options[@]}" -LE '^(long|lint)$'
fi

deploy/install.sh --dev
say "building (release), benchmarks and studies too"
deploy/build.sh --check release all cairn_benches cairn_studies
for sanitizer in asan tsan; do
  say "building ($sanitizer)"
  deploy/build.sh "$sanitizer" cairn_unit_tests
done
# One ctest over the three trees, so that one summary tells all.
mkdir -p build/all
printf 'subdirs("../release" "../asan" "../tsan")\n' >build/all/CTestTestfile.cmake
exec ctest --test-dir build/all "${options[@]}"
