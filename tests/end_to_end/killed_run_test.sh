#!/usr/bin/env bash
# kill -9 of the whole `cairn run` at several moments, then the same command again: the same bits, and no worker is left.
source "$(dirname "$0")/common.sh"
kills=${KILLS:-10}

cairn simulate loop --difficulty base --robots 3 --seed 5 log.h5 >/dev/null
job=(cairn run landmark_map log.h5 --set cell_m=0.4 --workers 2)
exits 0 "${job[@]}" --out undisturbed

# The moments are spread over the run by what it has saved, not by the clock: after the first checkpoint, the next, …
saved() { find killed/.cairn -name '*.h5' -newer mark 2>/dev/null | grep -q .; }
ended() { ! kill -0 "$run" 2>/dev/null; }
saved_or_ended() { saved || ended; }
killed=0
for ((i = 0; i < kills; ++i)); do
  touch mark
  "${job[@]}" --out killed >background.out 2>background.err &
  run=$!
  [ "$i" -eq 0 ] || until_true 120 saved_or_ended
  workers=$(pgrep -P "$run" -f cairn-worker || true)
  if kill -9 "$run" 2>/dev/null; then killed=$((killed + 1)); fi
  wait "$run" 2>/dev/null || true
  for worker in $workers; do
    gone() { ! kill -0 "$worker" 2>/dev/null || grep -q '^State:.Z' "/proc/$worker/status" 2>/dev/null; }
    until_true 20 gone
  done
done
[ "$killed" -gt 1 ] || die "the run was over before it could be killed twice"
exits 0 "${job[@]}" --out killed
says 'resumed'
same_bits undisturbed killed
if find killed -name '*.tmp' | grep -q .; then die "a half-written file is left: $(find killed -name '*.tmp')"; fi
