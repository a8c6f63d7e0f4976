#!/usr/bin/env bash
# Workers by a real kubectl, on a cluster that is this test's own (kubernetes_cluster.py): a pod is a process here. A pod that
# is killed, one that is deleted, a quota; the same bits, and no pod, Secret or key in the end.
#
# With CAIRN_POD_IMAGE, of this very build, coordinator and workers are podman's containers, with the environment, rights, limits,
# probes and signals of deploy/kubernetes; CAIRN_PODMAN is podman's command with its options. `deploy/image.sh --check` does it.
source "${CAIRN_SOURCE:?}/tests/end_to_end/common.sh"
command -v kubectl >/dev/null && command -v python3 >/dev/null || skip "needs kubectl and python3 (deploy/install.sh --cluster)"
read -ra podman <<<"${CAIRN_PODMAN:-podman}"
# A port that nobody has, twice.
ports() { python3 -c 'import socket; a, b = socket.socket(), socket.socket(); a.bind(("127.0.0.1", 0)); b.bind(("127.0.0.1", 0)); print(a.getsockname()[1], b.getsockname()[1])'; }
read -r api hub <<<"$(ports)"
leave() {
  local code=$?
  set +e
  # Its pods are no children of this shell, nor is it, where python3 is a script that calls another.
  [ ! -s pods/pid ] || { pgrep -P "$(cat pods/pid)"; cat pods/pid; } | xargs -r kill -9
  if [ -n "${CAIRN_POD_IMAGE:-}" ]; then
    "${podman[@]}" ps -a -q --filter name="cairn-coordinator-${pod:-0}" --filter name=kubernetes-test- | xargs -r "${podman[@]}" rm -f >/dev/null
  fi
  [ "$code" -eq 0 ] || tail -n 20 scale.log cluster.log >&2
  (exit "$code")
  cleanup
}
trap leave EXIT
cat >kubeconfig <<TEXT
{apiVersion: v1, kind: Config, current-context: here,
 clusters: [{name: here, cluster: {server: "http://127.0.0.1:$api"}}],
 contexts: [{name: here, context: {cluster: here, user: nobody, namespace: default}}],
 users: [{name: nobody, user: {}}]}
TEXT
export KUBECONFIG=$work/kubeconfig
for name in coordinator client; do exits 0 cairn keys new "$name" --dir keys; done
exits 0 cairn keys allow keys/client.pub --as submitter --dir keys
[ -z "${CAIRN_POD_IMAGE:-}" ] || hub=7017
service() { printf '%s\n' --connect "tcp://127.0.0.1:$hub" --key "$1/client.key" --server-key "$1/coordinator.pub"; }
mapfile -t here < <(service keys)
client() { local command=$1; shift; cairn "$command" "$@" "${here[@]}"; }
as=(env) what_runs=(--worker "$CAIRN_BIN/cairn-worker") hub_keys=keys
if [ -n "${CAIRN_POD_IMAGE:-}" ]; then # as whom the manifests say, who alone may read the keys in the volume
  hub_keys=data/keys
  as=(setpriv --reuid 10001 --regid 10001 --clear-groups env HOME="$work/data/home" CAIRN_HOME="$work/data/home")
  what_runs=(--image "$CAIRN_POD_IMAGE" --template "$CAIRN_SOURCE/deploy/kubernetes/worker-pod.yaml")
  chmod 711 .
  mkdir data
fi
mapfile -t there < <(service $hub_keys)
scale() {
  "${as[@]}" "$CAIRN_BIN/cairn" scale kubernetes --max 4 "${what_runs[@]}" --keys $hub_keys --name test --work-s 0.01 --idle-s 1 \
    --cool-down-s 0 --every-s 0.3 --drain-s 20 "${there[@]}" "$@"
}
serve() {
  if [ -z "${CAIRN_POD_IMAGE:-}" ]; then
    cairn coordinator --store store --listen "tcp://127.0.0.1:$hub" --keys keys >hub.log 2>&1 &
    until_true 20 client list >list.log 2>&1
    return
  fi
  python3 "$CAIRN_SOURCE/tests/faults/podman_pod.py" "$CAIRN_SOURCE/deploy/kubernetes/coordinator/coordinator.yaml" keys "$work/data" \
    >ready 2>hub.log &
  pod=$!
  until_true 60 grep -q ready ready
}
simulate log.h5
exits 0 cairn run landmark_map log.h5 --set cell_m=0.15 --out here --workers 2
serve

# A cluster that does not answer is said as kubectl says it.
exits 1 scale
says 'kubectl: .*refused'

mkdir pods
python3 "$CAIRN_SOURCE/tests/faults/kubernetes_cluster.py" "$api" "$work/pods" >cluster.log 2>&1 &
disown
until_true 20 kubectl get pods >list.log 2>&1
printf '%s\n' 'name: first' 'inputs: {log: log.h5}' \
  'stages: [{name: landmark_map, pipeline: landmark_map, log: log, options: {cell_m: 0.15}}]' >first.yaml
exits 0 client submit first.yaml --json
id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
scale --until-done >scale.log 2>&1 &
scaler=$!
connected() { client list 2>/dev/null | grep -qE "^($1|[1-9][0-9]) workers"; }
until_true 60 connected 3
until_true 60 grep -q 'exceeded quota' scale.log # four are wanted
names=(pods/*.log)
first=$(basename "${names[0]}" .log) second=$(basename "${names[1]}" .log)
[[ $first = kubernetes-test-* ]] || die "a pod is called $first"
[ "$(stat -c %a "pods/$first/worker.key")" = 600 ] || die "others may read its key"
if [ -n "${CAIRN_POD_IMAGE:-}" ]; then
  exits 0 "${podman[@]}" kill --signal KILL "$first"
else
  for pid in $(pgrep -P "$(cat pods/pid)" -f -- "--name $first"); do kill -9 "$pid"; done
fi
exits 0 kubectl delete pod "$second" --wait=false
exits 0 client watch "$id"
wait "$scaler" || die "scale ended with $?"
grep -qE "$first on here has ended: exit code 137" scale.log || die "it does not say how $first ended"
exits 0 client results "$id" --out there
same_bits here there
for what in pods secrets; do
  exits 0 kubectl get "$what" -l cairn-scale=kubernetes-test -o name
  [ ! -s stdout ] || die "$what are left: $(cat stdout)"
done
! grep -q ' worker kubernetes-' "$hub_keys/allowed" || die "keys are left: $(cat "$hub_keys/allowed")"
if [ -n "${CAIRN_POD_IMAGE:-}" ]; then # told to go, it goes in time, and the next one has its jobs
  kill "$pod"
  wait "$pod" || die "the coordinator's pod ended with $?: $(tail -n 3 hub.log)"
  serve
  exits 0 client status "$id"
  says 'done'
  kill "$pod"
  wait "$pod"
fi
