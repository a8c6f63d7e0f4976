#!/usr/bin/env bash
# Three hosts, as network namespaces of this test's own, each with an sshd, and the coordinator's: workers are started on
# them, found again, replaced where a host goes away, and gone in the end, with their keys. Needs root, ip and sshd.
source "${CAIRN_SOURCE:?}/tests/end_to_end/common.sh"
source "$CAIRN_SOURCE/tests/faults/namespaces.sh"

command -v sshd >/dev/null && command -v ssh-keygen >/dev/null ||
  skip "needs sshd and ssh-keygen (deploy/install.sh --cluster)"
before_leaving() { [ "$1" -eq 0 ] || tail -n 30 scale.log sshd?.log >&2; }
machine hub
hub=$(space hub)
ip -n "$hub" addr add 10.78.0.1/32 dev lo
mkdir -p /run/sshd
ssh-keygen -q -t ed25519 -N '' -f login
# serve_ssh N: an sshd there whose logins see a folder of the test's as their home.
serve_ssh() {
  local home=$work/host$1
  mkdir -p "$home"
  printf '%s\n' "ListenAddress 10.78.$1.2" "HostKey \"$work/host_key$1\"" "PidFile none" "StrictModes no" "UsePAM no" \
    "AuthorizedKeysFile \"$work/login.pub\"" "PermitRootLogin yes" "PasswordAuthentication no" "SetEnv \"HOME=$home\"" \
    "ForceCommand cd '$home' && HOME='$home' exec sh -c \"\$SSH_ORIGINAL_COMMAND\"" >"sshd$1.conf"
  on "host$1" "$(command -v sshd)" -D -f "$work/sshd$1.conf" -E "$work/sshd$1.log" &
}
for n in 0 1 2; do
  machine "host$n"
  wire hub "wire$n" "10.78.$n.1/24" "host$n" wire "10.78.$n.2/24"
  ip -n "$(space "host$n")" route add default via "10.78.$n.1"
  ssh-keygen -q -t ed25519 -N '' -f "host_key$n"
  echo "10.78.$n.2 $(cut -d ' ' -f 1,2 "host_key$n.pub")" >>known_hosts
  echo "10.78.$n.2 1" >>hosts.txt
  serve_ssh "$n"
done

for name in coordinator client; do exits 0 cairn keys new "$name" --dir keys; done
exits 0 cairn keys allow keys/client.pub --as submitter --dir keys
client_keys=(--key keys/client.key --server-key keys/coordinator.pub)
on_hub() { on hub "$@"; }
client() { local command=$1; shift; on_hub cairn "$command" "$@" --connect tcp://10.78.0.1:7017 "${client_keys[@]}"; }
scale() {
  on_hub cairn scale ssh --hosts "${hosts_file:-hosts.txt}" --worker "$CAIRN_BIN/cairn-worker" --keys keys --idle-s 1 --cool-down-s 0 \
    --work-s 0.01 --every-s 0.2 --ssh-option "IdentityFile=\"$work/login\"" \
    --ssh-option "UserKnownHostsFile=\"$work/known_hosts\"" "${client_keys[@]}" "$@"
}
scaled() { scale --connect tcp://10.78.0.1:7017 "$@"; }
simulate log.h5
exits 0 cairn run landmark_map log.h5 --set cell_m=0.25 --out here --workers 2
job() {
  printf 'name: %s\ninputs: {log: log.h5}\nstages: [{name: landmark_map, pipeline: landmark_map, log: log, options: {cell_m: 0.25}}]\n' \
    "$1" >"$1.yaml"
  exits 0 client submit "$1.yaml" --json
  id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
}
worker_keys() { grep -c ' worker ssh-' keys/allowed || true; }
connected() { [ "$(client list 2>/dev/null | grep -oE '^[0-9]+ workers?' | cut -d ' ' -f 1)" = "$1" ]; }

# What cannot work is said at once.
on_hub cairn coordinator --store store --listen 'tcp://*:7017' --keys keys >hub.log 2>&1 &
until_true 20 client list >/dev/null
echo 'nobody@10.78.0.9 1' >none.txt
hosts_file=none.txt exits 1 scaled
says '10.78.0.9'

# A job on three hosts; whoever looks after them is killed and another goes on; then all go, and so do their keys.
job first
scaled >scale.log 2>&1 &
scaler=$!
until_true 30 connected 3
[ "$(worker_keys)" -eq 3 ] || die "$(worker_keys) keys of three workers"
for n in 0 1 2; do
  ls "host$n"/.cairn/scale/*/*/*.key >key 2>/dev/null || die "host $n has no key of its worker's"
  [ "$(stat -c %a "$(cat key)")" = 600 ] || die "others may read $(cat key)"
done
pkill -9 -P "$scaler" || die "whoever looks after the workers has ended: $(cat scale.log)"
wait "$scaler" 2>/dev/null || true
exits 0 client watch "$id"
exits 0 scaled --until-done
says 'leaves'
exits 0 client results "$id" --out there
same_bits here there
[ "$(worker_keys)" -eq 0 ] || die "keys are left: $(cat keys/allowed)"
for n in 0 1 2; do
  [ -z "$(ip netns pids "$(space "host$n")" | xargs -r -n 1 -I{} cat /proc/{}/comm 2>/dev/null | grep cairn-worker)" ] ||
    die "host $n still has a worker"
done

# A host goes away while it works: it is left alone, the others go on, the same bits.
job second
scaled --until-done >scale.log 2>&1 &
scaler=$!
until_true 30 connected 3
ip -n "$hub" link set wire2 down
until_true 60 grep -q '10.78.2.2 is left alone for a while' scale.log
exits 0 client watch "$id"
ip -n "$hub" link set wire2 up
wait "$scaler" || die "scale ended with $?: $(cat scale.log)"
exits 0 client results "$id" --out second
same_bits here second
[ "$(worker_keys)" -eq 0 ] || die "keys are left: $(cat keys/allowed)"

# A host key that changed: what ssh says of it, no worker there.
for pid in $(ip netns pids "$hub"); do # whose connections are known already
  [ "$(cat "/proc/$pid/comm" 2>/dev/null)" != ssh ] || kill "$pid"
done
sed -i "s|^10.78.1.2 .*|10.78.1.2 $(cut -d ' ' -f 1,2 login.pub)|" known_hosts
job third
scaled --until-done >scale.log 2>&1 || die "scale ended with $?: $(cat scale.log)"
grep -q '10.78.1.2 is left alone for a while: .*ost key verification failed' scale.log || die "$(cat scale.log)"

# A coordinator that the hosts cannot reach, but through ssh.
on_hub cairn coordinator --store inner --listen tcp://127.0.0.1:7018 --keys keys >inner.log 2>&1 &
inner=(--connect tcp://127.0.0.1:7018 "${client_keys[@]}")
until_true 20 on_hub cairn list "${inner[@]}" >/dev/null
exits 0 on_hub cairn submit first.yaml "${inner[@]}"
scale --connect tcp://127.0.0.1:7018 --tunnel 7118 --until-done >scale.log 2>&1 || die "scale ended with $?: $(cat scale.log)"
exits 0 on_hub cairn results --name first --out inside "${inner[@]}"
same_bits here "inside/$(ls inside)"
