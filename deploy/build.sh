#!/usr/bin/env bash
# Configures and builds.
#
#   deploy/build.sh [--check] [PRESET [TARGET…]]
#
# PRESET: release (default), debug, asan, asan-all, tsan. --check: warnings are errors, in that tree from now on.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

case ${1:-} in
  -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
options=()
if [ "${1:-}" = --check ]; then
  options=(-D CAIRN_WERROR=ON)
  shift
fi
preset=${1:-release}
shift || true
targets=()
[ $# -gt 0 ] && targets=(--target "$@")
log=build/$preset/configure.log
mkdir -p "build/$preset"
cmake --preset "$preset" "${options[@]}" >"$log" 2>&1 || { cat "$log" >&2; fail "the build could not be configured"; }
cmake --build --preset "$preset" --parallel "$(cairn_jobs)" "${targets[@]}" >&2
