#!/usr/bin/env bash
# Two machines, as network namespaces of this test's own: a partition, a quarter of all packets lost, connections that are
# reset. Every job ends with the undisturbed bits. Needs root, ip and nft.
source "$CAIRN_SOURCE/tests/end_to_end/common.sh"
source "$CAIRN_SOURCE/tests/faults/namespaces.sh"

command -v nft >/dev/null || skip "needs nft (nftables)"
machine hub
machine desk
wire hub wire0 10.77.0.1/24 desk wire0 10.77.0.2/24
hub=$(space hub)
on_hub() { on hub "$@"; }
on_desk() { on desk "$@"; }
on_hub nft 'table inet probe {}' 2>/dev/null || skip "nft cannot do its work here"

for name in coordinator worker client; do exits 0 cairn keys new "$name" --dir keys; done
exits 0 cairn keys allow keys/worker.pub --as worker --dir keys
exits 0 cairn keys allow keys/client.pub --as submitter --dir keys
coordinator_keys=(--keys keys)
worker_keys=(--key keys/worker.key --server-key keys/coordinator.pub)
client_keys=(--key keys/client.key --server-key keys/coordinator.pub)

simulate log.h5
exits 0 cairn run landmark_map log.h5 --set cell_m=0.5 --out here --workers 1
service() {
  on_hub cairn coordinator --store store --listen tcp://10.77.0.1:7017 "${coordinator_keys[@]}" >>hub.log 2>&1 &
}
worker() { on_desk cairn worker --connect tcp://10.77.0.1:7017 "${worker_keys[@]}" >>desk.log 2>&1 & }
client() { local command=$1; shift; on_hub cairn "$command" "$@" --connect tcp://10.77.0.1:7017 "${client_keys[@]}"; }
connected() { client list 2>/dev/null | grep -q "^$1 workers"; }
service
worker
worker
until_true 30 connected 2

# job NAME: submits; each name is another job, so that it is computed anew.
job() {
  printf 'name: %s\ninputs: {log: log.h5}\nstages: [{name: landmark_map, pipeline: landmark_map, log: log, options: {cell_m: 0.5}}]\n' \
    "$1" >"$1.yaml"
  exits 0 client submit "$1.yaml" --json
  id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
}
state() { client status "$id" --json 2>/dev/null | grep -oE '"state": ?"[^"]+"' | cut -d'"' -f4; }
begun() { [ "$(state)" != queued ]; }
done_with() { [ "$(state)" = done ]; }
same() {
  until_true 120 done_with
  exits 0 client results "$id" --out "$1"
  same_bits here "$1"
  printf '%s: the undisturbed bits\n' "$1"
}

job partition
until_true 60 begun
ip -n "$hub" link set wire0 down
printf 'the partition begins while the job is %s\n' "$(state)"
sleep 3 # a partition has to last
ip -n "$hub" link set wire0 up
ip -n "$hub" addr replace 10.77.0.1/24 dev wire0
same partition

job loss
on_desk nft 'table inet fault { chain in { type filter hook input priority 0; policy accept; numgen random mod 100 lt 25 drop; } ; }'
same loss
[ "$(on_desk nft list ruleset | grep -c numgen)" -eq 1 ] || die "there was no loss"
on_desk nft delete table inet fault

job reset
until_true 60 begun
on_hub nft 'table inet fault { chain in { type filter hook input priority 0; policy accept; iifname "wire0" tcp dport 7017 counter reject with tcp reset; } ; }'
until_true 60 bash -c "ip netns exec $hub nft list ruleset | grep -qE 'counter packets [1-9]'"
on_hub nft delete table inet fault
same reset
