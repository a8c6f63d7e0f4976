#!/usr/bin/env bash
# Real images: the Sussex route, by the commands of docs/datasets.md.
source "$(dirname "$0")/common.sh"
[ -n "${CAIRN_DATA:-}" ] && [ -d "$CAIRN_DATA/sussex-route" ] || skip "CAIRN_DATA names no folder that holds sussex-route"
command -v python3 >/dev/null || skip "there is no python3"

runs_section 'Sussex route'
grep -q '^images.h5: 2 runs, 551 samples, 0 inputs$' said || die "other images: $(cat said)"
grep -q 'skipped 40: no pose at its time' errors || die "other images skipped: $(cat errors)"
exits 0 cairn inspect route/image_features.h5
says '551 samples in 2 runs, 140 inputs each'
says 'run training +455 samples over 60.59 s'
says 'run infomax_binary +96 samples over'
