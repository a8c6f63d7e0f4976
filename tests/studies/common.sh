# Sourced by the studies and benchmarks that read what a program prints: a figure that is not there ends the script.
# shellcheck shell=bash

# figure WHAT TEXT: prints TEXT, which must be a number. Only in an assignment of its own (`x=$(figure …)`) does a failure
# end the script; in an argument it would be lost.
figure() {
  [[ $2 =~ ^-?[0-9]+(\.[0-9]+)?([eE][-+]?[0-9]+)?$ ]] || { echo "no figure: $1 is '$2'" >&2; return 1; }
  printf '%s\n' "$2"
}
