#!/usr/bin/env bash
# Configures and builds: deploy/build.sh [PRESET [TARGET…]]. PRESET: release (default), debug, asan, tsan.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

preset=${1:-release}
shift || true
targets=()
[ $# -gt 0 ] && targets=(--target "$@")
log=build/$preset/configure.log
mkdir -p "build/$preset"
cmake --preset "$preset" >"$log" 2>&1 || { cat "$log" >&2; fail "the build could not be configured"; }
cmake --build --preset "$preset" --parallel "$(cairn_jobs)" "${targets[@]}" >&2
