#!/usr/bin/env bash
# Follows docs/fleet.md: keys, a coordinator and a worker over TCP, a job. A client without a key is refused.
source "$(dirname "$0")/common.sh"

simulate log.h5
port=$((20000 + RANDOM % 20000))
awk '/^```sh$/ {on = 1; next} /^```$/ {on = 0} on' "$CAIRN_SOURCE/docs/fleet.md" | sed "s/7017/$port/" >commands
[ "$(wc -l <commands)" -ge 9 ] || die "the page has lost its commands"
while IFS= read -r command; do
  case $command in
    *'&')
      # In this shell, so that it is cleaned up with it.
      eval "${command%&} >>log 2>&1 &"
      ;;
    *watch*)
      # It may be over before it is watched.
      bash -uc "$command" >stdout 2>stderr || grep -q 'no job is running' stderr || die "failed: $command"
      ;;
    *) bash -euc "$command" >stdout 2>stderr || die "failed: $command" ;;
  esac
done <commands
says 'landmark_map'
client=(--connect "tcp://127.0.0.1:$port" --key keys/client.key --server-key keys/coordinator.pub)
job=$(cairn list "${client[@]}" --json | grep -oE '"id": ?"[^"]+"' | head -n 1 | cut -d'"' -f4)
exits 0 cairn watch "$job" "${client[@]}"
exits 0 cairn results "$job" --out there "${client[@]}"
exits 0 cairn run landmark_map log.h5 --out here --workers 1
same_bits here there

exits 0 cairn keys keys/stranger
refuses 'key' cairn list --connect "tcp://127.0.0.1:$port" --key keys/stranger.key --server-key keys/coordinator.pub
