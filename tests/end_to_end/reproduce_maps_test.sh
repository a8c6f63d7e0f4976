#!/usr/bin/env bash
# Occupancy's and the office's figures, each from one command, its help's example but with one seed: all pictures are there,
# and a second call computes nothing anew.
source "$(dirname "$0")/common.sh"

# shows_figures FOLDER: its page is whole and shows pictures that are there.
shows_figures() {
  local pictures picture
  grep -q '</html>' "$1/index.html" || die "the page of $1 is cut off"
  pictures=$(grep -oE 'src="[^"]*"' "$1/index.html" | cut -d'"' -f2)
  [ -n "$pictures" ] || die "the page of $1 shows no picture"
  for picture in $pictures; do
    head -c 8 "$1/$picture" | grep -q PNG || die "$1/$picture is no PNG"
  done
}

# twice FOLDER COMMAND…: runs it, and again.
twice() {
  local folder=$1 result before
  shift
  exits 0 "$@"
  shows_figures "$folder"
  result=$(find "$folder/results" -name '*.h5' | sort | head -n 1)
  [ -n "$result" ] || die "no result of $folder is left"
  before=$(stat -c '%i %Y' "$result")
  exits 0 "$@"
  [ "$before" = "$(stat -c '%i %Y' "$result")" ] || die "a finished result was computed again: $result"
}

line=$(cairn-reproduce occupancy --help | examples_in)
[ "$line" = 'cairn-reproduce occupancy --seeds 5 --out occupancy' ] || die "its example is another: $line"
twice occupancy ${line/--seeds 5/--seeds 1}
line=$(cairn-reproduce local --help | examples_in)
[ "$line" = 'cairn-reproduce local --seeds 5 --out local' ] || die "its example is another: $line"
twice local ${line/--seeds 5/--seeds 1}
