#!/usr/bin/env bash
# Real images with ranges: Big Wheel Bot's garden, by the commands of docs/datasets.md.
source "$(dirname "$0")/common.sh"
[ -n "${CAIRN_DATA:-}" ] && [ -d "$CAIRN_DATA/bigwheel-sonar-camera" ] ||
  skip "CAIRN_DATA names no folder that holds bigwheel-sonar-camera"
command -v python3 >/dev/null || skip "there is no python3"

runs_section 'Big Wheel Bot'
grep -q '^garden-images.h5: 2 runs, 424 samples, 4 inputs$' said || die "other images: $(cat said)"
exits 0 cairn inspect garden/image_features.h5
says '424 samples in 2 runs, 144 inputs each'
says 'run first half +212 samples over 63.3 s'
