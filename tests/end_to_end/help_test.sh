#!/usr/bin/env bash
# Every command has --help with an example, and knows a wrong option when it sees one.
source "$(dirname "$0")/common.sh"

commands=$(cairn --help | awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on && /^  [a-z]/ {print $1}')
[ "$(wc -w <<<"$commands")" -ge 12 ] || die "cairn --help lists too few commands: $commands"
for command in $commands; do
  exits 0 cairn "$command" --help
  says 'xample'
  [ "$command" = worker ] || refuses 'no-such-option|required' cairn "$command" --no-such-option
done
