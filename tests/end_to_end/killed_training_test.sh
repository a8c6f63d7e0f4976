#!/usr/bin/env bash
# kill -9 at KILLS (6) moments drawn from SEED (1), of the whole run or of one of its workers; each time the same command again: in
# the end the same bits.
source "$(dirname "$0")/common.sh"
kills=${KILLS:-6}
RANDOM=${SEED:-1}

cairn simulate corridor --seed 3 --runs 3 --snapshots 500 corridor.h5 >/dev/null
job=(cairn run landmark_learning corridor.h5 --set "holdout=d1 run 3" --set steps=6000 --set patience=100000
  --workers 2 --checkpoint-rounds 40)
exits 0 "${job[@]}" --out undisturbed

# A worker that is killed is started again by its run, which goes on; a run that is killed is begun again.
whole=0 workers=0 run=0 ended=0
alive() { [ "$run" -ne 0 ] && kill -0 "$run" 2>/dev/null; }
# The first checkpoint (1.h5) says no more than that there is a job: of a run that is killed before the second nothing is resumed.
saved() { [ -n "$(find killed/.cairn/checkpoints -name '*.h5' ! -name 1.h5 2>/dev/null)" ]; }
begin() {
  "${job[@]}" --out killed >background.out 2>background.err &
  run=$!
  while alive && ! saved; do sleep 0.05; done
}
while [ $((whole + workers)) -lt "$kills" ]; do
  alive || begin
  sleep "0.$(printf '%03d' $((100 + RANDOM % 400)))"
  if ! alive; then  # a fast machine: its end counts as well, and the next kills are of another run
    wait "$run" || die "the run ended badly: $(cat background.err)"
    same_bits undisturbed killed
    rm -r killed
    run=0
    ended=$((ended + 1))
    [ "$ended" -le "$kills" ] || die "the run is over before anything can be killed"
    continue
  fi
  if ((RANDOM % 4 == 0)); then
    worker=$(pgrep -P "$run" -f cairn-worker | head -n 1 || true)
    [ -n "$worker" ] && kill -9 "$worker" 2>/dev/null && workers=$((workers + 1))
  else
    kill -9 "$run"
    wait "$run" 2>/dev/null || true
    whole=$((whole + 1)) run=0
  fi
done
if alive; then
  wait "$run" || die "the run ended badly: $(cat background.err)"
fi
exits 0 "${job[@]}" --out killed
says 'resumed|finished already'
printf 'killed: the run %d times, a worker %d times; it came to its end %d times between\n' "$whole" "$workers" "$ended"
same_bits undisturbed killed
