#!/usr/bin/env bash
# kill -9 of the whole `cairn run` at several moments, then the same command again: the same bits, and no worker is left.
# KILLS=10 and more: the long version.
source "$(dirname "$0")/common.sh"
kills=${KILLS:-3}

cairn simulate loop --difficulty base --robots 2 --seed 5 log.h5 >/dev/null
job=(cairn run landmark_map log.h5 --set cell_m=0.4 --set starts=3 --set waves=0 --workers 2 --checkpoint-rounds 1)
exits 0 "${job[@]}" --out undisturbed

# The moments are spread over the run by what it has saved, not by the clock: after the first checkpoint, the next, …
saved() { find killed/.cairn/checkpoints -name '[0-9]*.h5' -newer mark 2>/dev/null | grep -q .; }
ended() { ! kill -0 "$run" 2>/dev/null; }
saved_or_ended() { saved || ended; }
# life WAIT: starts or resumes the run and kills it, at once or when it has saved more; sets `cut`: that came before its end.
life() {
  local workers worker
  touch mark
  "${job[@]}" --out killed >background.out 2>background.err &
  run=$! cut=0
  [ "$1" -eq 0 ] || until_true 120 saved_or_ended
  workers=$(pgrep -P "$run" -f cairn-worker || true)
  if kill -9 "$run" 2>/dev/null; then cut=1; fi
  wait "$run" 2>/dev/null || true
  if [ -e killed/landmark_map.h5 ]; then cut=0; fi
  for worker in $workers; do
    gone() { ! kill -0 "$worker" 2>/dev/null || grep -q '^State:.Z' "/proc/$worker/status" 2>/dev/null; }
    until_true 20 gone
  done
}
killed=0
# On a busy machine a run may end before it is looked at: then anew.
for ((i = 0; i < kills || (cut == 0 && i < 4 * kills); ++i)); do
  life "$i"
  killed=$((killed + cut))
  if [ "$cut" -eq 0 ]; then rm -rf killed; fi
done
[ "$killed" -gt 1 ] || die "the run was over before it could be killed twice"
exits 0 "${job[@]}" --out killed
says 'resumed'
same_bits undisturbed killed
if find killed -name '*.tmp' | grep -q .; then die "a half-written file is left: $(find killed -name '*.tmp')"; fi

# How much a kill loses: a finer job, killed whenever its workers have computed for so long (hundredths of a second of
# processor time, not the clock, so that a busy machine does not matter). What a life had computed when its newest
# checkpoint appeared is kept, what it computed since is lost. Both are of the same life: two whole runs on a busy
# machine differ by more than a kill loses. FINE_KILLS=10 FINE_SETTINGS='cell_m=0.15 heading_deg=2 starts=1' is the
# long version.
fine_kills=${FINE_KILLS:-2}
settings=()
for pair in ${FINE_SETTINGS:-cell_m=0.3 heading_deg=3 starts=1}; do settings+=(--set "$pair"); done
cairn simulate loop --difficulty base --seed 5 fine.h5 >/dev/null
fine=(cairn run landmark_map fine.h5 "${settings[@]}" --workers 2)
computed() { # PID: what its workers have used
  local all=0 used worker
  for worker in $(pgrep -P "$1" -f cairn-worker || true); do
    used=$(awk '{print $14 + $15}' "/proc/$worker/stat" 2>/dev/null || true)
    all=$((all + ${used:-0}))
  done
  echo $((all * 100 / $(getconf CLK_TCK)))
}
newest() { find "$1/.cairn/checkpoints/run" -name '[0-9]*.h5' -printf '%f\n' 2>/dev/null | sort -n | tail -n 1 || true; }
# live LIMIT DIR: runs until done or until the limit is used up; sets `used`, `kept` and `code`.
live() {
  local now checkpoint seen
  seen=$(newest "$2")
  "${fine[@]}" --out "$2" >background.out 2>background.err &
  run=$! used=0 kept=0 code=0
  while kill -0 "$run" 2>/dev/null; do
    checkpoint=$(newest "$2")
    [ "$checkpoint" = "$seen" ] || kept=$used seen=$checkpoint
    now=$(computed "$run")
    [ "$now" -le "$used" ] || used=$now
    [ "$used" -lt "$1" ] || kill -9 "$run" 2>/dev/null || true
    sleep 0.05
  done
  wait "$run" 2>/dev/null || code=$?
}
live 1000000 whole
[ "$code" -eq 0 ] || die "the undisturbed run failed: $(cat background.err)"
whole=$used
lived=0 lost=0
for ((i = 0; i < fine_kills; ++i)); do
  live $((whole / (fine_kills + 1))) pieces
  [ "$code" -eq 137 ] || die "life $i ended with $code before it was killed: $(cat background.err)"
  [ "$kept" -gt 0 ] || die "life $i saved nothing"
  lived=$((lived + used)) lost=$((lost + used - kept))
done
live 1000000 pieces
[ "$code" -eq 0 ] || die "the resumed run failed: $(cat background.err)"
grep -q 'resumed' background.out || die "the last run did not resume: $(cat background.out)"
same_bits whole pieces
again=$((lived + used - whole))
printf 'undisturbed %d.%02d s of processor time; killed %d times, %d hundredths lost, %d a kill; all lives %d more\n' \
  $((whole / 100)) $((whole % 100)) "$fine_kills" "$lost" $((lost / fine_kills)) "$again"
[ "$lost" -lt $((120 * fine_kills)) ] || die "a kill loses much more than a second's work"
# That the next life goes on from what was kept.
[ "$again" -lt $((lived / 2)) ] || die "more than half of what the killed runs had done was done again"
