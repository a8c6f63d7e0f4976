#!/usr/bin/env bash
# deploy/kubernetes on a real cluster: a job that pods started by `cairn scale kubernetes` compute, one of which is deleted
# meanwhile; the same bits as here, and nothing left. No part of ctest: it needs a cluster, and images that it can pull.
#
#   KUBECONFIG=… CAIRN_BIN=$PWD/build/release/bin CAIRN_SOURCE=$PWD tests/end_to_end/kubernetes.sh IMAGE KUBECTL_IMAGE
#
# IMAGE, KUBECTL_IMAGE: of deploy/image.sh and deploy/image.sh --kubectl, in a registry of the cluster's, of this very build.
# It makes the namespace cairn-test-PID and deletes it. Exit code 77: nothing was run.
KUBECONFIG=${KUBECONFIG:+$(realpath -- "$KUBECONFIG")}
source "$(dirname "$0")/common.sh"
command -v kubectl >/dev/null || skip "needs kubectl: nothing was run"
[ -n "$KUBECONFIG" ] || skip "KUBECONFIG names no cluster: nothing was run"
export KUBECONFIG
[ $# -eq 2 ] || { echo "usage: kubernetes.sh IMAGE KUBECTL_IMAGE" >&2; exit 2; }
image=$1 kubectl_image=$2 namespace=cairn-test-$$
kube() { kubectl --namespace "$namespace" "$@"; }
leave() {
  local code=$?
  set +e
  [ "$code" -eq 0 ] || kube logs cairn-coordinator-0 --all-containers --tail 30 >&2
  kubectl delete namespace "$namespace" --wait=false >/dev/null 2>&1
  (exit "$code")
  cleanup
}
trap leave EXIT

for name in coordinator client; do exits 0 cairn keys new "$name" --dir keys; done
exits 0 cairn keys allow keys/client.pub --as submitter --dir keys
cp -r "$CAIRN_SOURCE/deploy/kubernetes" manifests
mkdir here
cat >here/kustomization.yaml <<TEXT
apiVersion: kustomize.config.k8s.io/v1beta1
kind: Kustomization
namespace: $namespace
resources: [../manifests]
images:
  - {name: cairn, newName: ${image%:*}, newTag: "${image##*:}"}
  - {name: cairn-kubectl, newName: ${kubectl_image%:*}, newTag: "${kubectl_image##*:}"}
patches:
  - target: {kind: Namespace}
    patch: '[{"op": "replace", "path": "/metadata/name", "value": "$namespace"}]'
TEXT
sed -i "s|- image=cairn:[^ ]*|- image=$image|" manifests/kustomization.yaml
exits 0 kubectl create namespace "$namespace"
exits 0 kube create secret generic cairn-coordinator --from-file keys
exits 0 kubectl apply -k here
exits 0 kube rollout status statefulset/cairn-coordinator --timeout 300s

simulate log.h5
exits 0 cairn run landmark_map log.h5 --set cell_m=0.2 --out local --workers 2
kube port-forward cairn-coordinator-0 7017:7017 >forward.log 2>&1 &
service=(--connect tcp://127.0.0.1:7017 --key keys/client.key --server-key keys/coordinator.pub)
until_true 20 cairn list "${service[@]}" >list.log 2>&1
printf '%s\n' 'name: cluster' 'inputs: {log: log.h5}' \
  'stages: [{name: landmark_map, pipeline: landmark_map, log: log, options: {cell_m: 0.2}}]' >job.yaml
exits 0 cairn submit job.yaml "${service[@]}"
pods() { kube get pods -l cairn-scale=kubernetes-main -o name; }
some() { [ -n "$(pods)" ]; }
until_true 120 some
kube delete "$(pods | head -n 1)" --wait=false
exits 0 cairn watch "${service[@]}"
exits 0 cairn results --name cluster --out there "${service[@]}"
same_bits local "there/$(ls there)"
gone() { [ -z "$(pods)" ] && [ -z "$(kube get secrets -l cairn-scale=kubernetes-main -o name)" ]; }
until_true 180 gone
exits 0 kube exec cairn-coordinator-0 -c coordinator -- cairn keys show --dir /data/keys
! grep -q kubernetes-main- stdout || die "keys are left: $(cat stdout)"
echo "a job on the cluster: the same bits, nothing left"
