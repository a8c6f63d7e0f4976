#!/usr/bin/env bash
# Format and clang-tidy, version 19 of both.
#
#   deploy/lint.sh            clang-tidy on the sources that changed since main (on main: since the last commit)
#   deploy/lint.sh --all      clang-tidy on all of them, which takes a while
#   deploy/lint.sh --format   the format check of all files; --fix formats them
#
# clang-tidy reads the flags of a tree of its own, build/lint, in which each source is compiled by itself; of it only
# generated headers are built. A change of more than 30 sources is linted in part, the same part each time, and says so.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"
most_sources=30
tree=build/lint

sources() { git ls-files -z -- '*.cc' '*.h' "$@"; }

# main's last commit where this is a branch, else the commit before this one; nothing where there is neither.
base_commit() {
  local base head
  head=$(git rev-parse HEAD)
  for name in main origin/main; do
    base=$(git merge-base HEAD "$name" 2>/dev/null) || continue
    [ "$base" != "$head" ] && echo "$base" && return
  done
  git rev-parse --verify -q HEAD~1 || true
}

# Of the sources on stdin those that CMake knows: clang-tidy knows no flags for the others (the fuzzers').
compiled() {
  local file
  while IFS= read -r -d '' file; do
    if grep -qF "\"file\": \"$root/$file\"" "$tree/compile_commands.json"; then printf '%s\0' "$file"; fi
  done
}

tidy() {
  mkdir -p "$tree"
  { cmake --preset release -B "$tree" -D CAIRN_UNITY=OFF && cmake --build "$tree" --target cairn_generated; } \
    >"$tree/configure.log" 2>&1 || { cat "$tree/configure.log" >&2; fail "clang-tidy's tree could not be configured"; }
  # It counts the warnings that it keeps to itself on stderr; those lines are noise.
  compiled | xargs -0 -r -n 1 -P "$(cairn_jobs)" clang-tidy-19 -p "$tree" --quiet --warnings-as-errors='*' \
    2> >(grep -vE '^[0-9]+ warnings? generated\.$' >&2)
}

case ${1:-} in
  --format) sources | xargs -0 -r clang-format-19 --dry-run --Werror ;;
  --fix) sources | xargs -0 -r clang-format-19 -i ;;
  --all) git ls-files -z -- '*.cc' | tidy ;;
  '')
    base=$(base_commit)
    mapfile -d '' -t changed < <(git diff -z --name-only --diff-filter=d "${base:-HEAD}" -- '*.cc')
    total=${#changed[@]}
    if ((total > most_sources)); then
      say "$total sources changed; clang-tidy reads the first $most_sources (deploy/lint.sh --all reads all)"
      changed=("${changed[@]:0:most_sources}")
    fi
    ((total == 0)) || printf '%s\0' "${changed[@]}" | tidy
    ;;
  -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0" ;;
  *) fail "unknown argument '$1'; allowed: --all, --format, --fix" ;;
esac
