# Sourced by the end-to-end tests. Each runs the built programs as a person would, in a folder of its own that is gone
# afterwards. CAIRN_BIN: the folder of the programs; CAIRN_SOURCE: the sources.
# shellcheck shell=bash
set -euo pipefail
PATH=${CAIRN_BIN:?}:$PATH
export CAIRN_SOURCE=${CAIRN_SOURCE:?}
work=$(mktemp -d "${TMPDIR:-/tmp}/cairn test XXXXXX")
export HOME=$work CAIRN_HOME=$work/home
unset CAIRN_COORDINATOR
cd "$work"

cleanup() {
  local code=$?
  set +e  # what is left undone here would live on, and ctest wait for it
  # Only what this test started: its own jobs.
  jobs -p | xargs -r kill -9 2>/dev/null
  rm -rf "$work"
  exit "$code"
}
trap cleanup EXIT

die() {
  printf 'FAILED: %s\n' "$*" >&2
  [ ! -s stderr ] || sed 's/^/  stderr: /' stderr >&2
  exit 1
}

# skip WHY: ctest counts 77 as skipped.
skip() {
  printf 'SKIPPED: %s\n' "$*"
  exit 77
}

# exits CODE COMMAND…: runs it, keeps what it says in the files stdout and stderr, demands its exit code.
exits() {
  local want=$1 code=0
  shift
  "$@" >stdout 2>stderr || code=$?
  [ "$code" -eq "$want" ] || die "exit code $code, not $want: $*"
}

# says PATTERN: an extended regular expression that a line of the last command's output must match.
says() { grep -Eq -- "$1" stdout stderr || die "does not say '$1': $(cat stdout)"; }

# refuses PATTERN COMMAND…: exit code 2, one line "cairn: …" that matches, no trace of a crash.
refuses() {
  local pattern=$1
  shift
  exits 2 "$@"
  [ "$(grep -c '^cairn: ' stderr)" -eq 1 ] || die "not one line of complaint: $*"
  grep -Eq -- "^cairn: .*($pattern)" stderr || die "does not say '$pattern': $*"
  ! grep -Eqi 'terminate called|assert|backtrace|core dumped|#[0-9]+ 0x' stderr || die "a trace of a crash: $*"
}

# same_bits A B: `cairn diff` finds no difference.
same_bits() { cairn diff "$1" "$2" >diff.out 2>&1 || { cat diff.out >&2; die "$1 and $2 differ"; }; }

# number KEY FILE: the first number of that key in a JSON file, "null" where it is null.
number() { tr -d ' \n' <"$2" | grep -oE "\"$1\":(-?[0-9.eE+-]+|null|true|false)" | head -n 1 | cut -d: -f2; }

# below A B: A < B, as numbers.
below() { awk -v a="$1" -v b="$2" 'BEGIN {exit !(a != "null" && a + 0 < b + 0)}' || die "$1 is not below $2"; }

# until_true SECONDS COMMAND…: waits for it; gives up, and fails, after five times that long: a slow machine is no fault.
until_true() {
  local tries=$(($1 * 100))
  shift
  until "$@"; do
    ((tries-- > 0)) || die "never came true: $*"
    sleep 0.05
  done
}

# example COMMAND…: the lines after "Example:" in its help.
examples_in() { awk 'on && /^  / {sub(/^  /, ""); print} /^Example:/ {on = 1}'; }
example() { cairn "$@" --help | examples_in; }

# A job of a few seconds, the same in every test.
simulate() { cairn simulate loop --difficulty paper --seed "${2:-7}" "$1" >/dev/null; }

# runs_section TITLE: the commands of that section of docs/datasets.md, one by one; what they say goes into `said`, their
# complaints into `errors`.
runs_section() {
  local command
  ln -sfn "$CAIRN_SOURCE/docs" docs
  awk -v title="### $1" '/^###? / {page = $0 == title} page && /^```sh$/ {on = 1; next} /^```$/ {on = 0} on' \
    docs/datasets.md >commands
  grep -q 'cairn' commands || die "docs/datasets.md has lost the commands of '$1'"
  while IFS= read -r command; do
    bash -euc "$command" </dev/null >>said 2>>errors || die "the page's command failed: $command $(cat errors)"
  done <commands
}
