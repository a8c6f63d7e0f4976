#!/usr/bin/env bash
# Follows docs/fleet.md: keys, a coordinator and a worker over TCP, a job. A client without a key is refused.
source "$(dirname "$0")/common.sh"

simulate log.h5
mkdir logs && cp log.h5 logs/monday.h5 && cp log.h5 logs/tuesday.h5
port=$((20000 + RANDOM % 20000))
awk '/^```sh$/ {on = 1; next} /^```$/ {on = 0} on' "$CAIRN_SOURCE/docs/fleet.md" | sed "s/7017/$port/" >commands
[ "$(wc -l <commands)" -ge 9 ] || die "the page has lost its commands"
while IFS= read -r command; do
  case $command in
    *'&')
      # In this shell, so that it is cleaned up with it.
      eval "${command%&} >>log 2>&1 &"
      ;;
    export\ *) eval "$command" ;;
    *) bash -euc "$command" >stdout 2>stderr || die "failed: $command" ;;
  esac
done <commands
for day in monday tuesday; do ls maps/*"landmark_map-$day"/landmark_map.h5 >/dev/null || die "no map of $day"; done
keys=$HOME/.config/cairn
job=$(cairn list --json | grep -oE '"id": ?"[^"]+"' | head -n 1 | cut -d'"' -f4)
exits 0 cairn watch "$job"
exits 0 cairn results "$job" --out there
exits 0 cairn run landmark_map log.h5 --out here --workers 1
same_bits here there

# No secret is in a log, and secrets are the owner's alone.
for name in coordinator worker client; do
  secret=$(awk '$2 == "secret" {print $1}' "$keys/$name.key")
  [ ${#secret} -eq 40 ] || die "$name.key holds no secret"
  ! grep -qF -- "$secret" log stdout stderr || die "a secret key was logged"
  [ "$(stat -c %a "$keys/$name.key")" = 600 ] || die "$name.key is not its owner's alone"
done

# A stranger; a worker's key that submits; a viewer that cancels.
exits 0 cairn keys new stranger
refuses 'does not know this key' cairn list --key "$keys/stranger.key"
refuses 'submit is not for a worker' cairn submit landmark_map log.h5 --seed 3 --key "$keys/worker.key"
exits 0 cairn keys allow "$keys/stranger.pub" --as viewer
exits 0 cairn list --key "$keys/stranger.key"
refuses "'cancel' is not for a viewer" cairn cancel "$job" --key "$keys/stranger.key"
exits 0 cairn list --json
says '"key": [1-9]'
says '"right": 2'
exits 0 cairn list
says '^refused  .*key [1-9].*right 2'

# A worker whose key is revoked leaves at once, and says why.
worker=$(pgrep -P $$ -x cairn-worker)
[ -n "$worker" ] || die "no worker runs"
exits 0 cairn keys revoke worker
code=0
wait "$worker" || code=$?
[ "$code" -eq 2 ] || die "a revoked worker ended with $code"
grep -q 'taken off the list' log || die "a revoked worker does not say why it ends"
exits 0 cairn list
says '^0 workers'
refuses 'not on the list' cairn keys revoke worker
chmod 640 "$keys/client.key"
refuses 'others can read this secret key' cairn list
chmod 600 "$keys/client.key"
refuses 'TCP needs keys|coordinator.key' cairn coordinator --store other --listen tcp://127.0.0.1:1 --keys "$work"
