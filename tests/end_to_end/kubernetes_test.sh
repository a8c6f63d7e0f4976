#!/usr/bin/env bash
# The manifests in deploy/kubernetes: what they let containers do, by python3-yaml; what kubectl makes of them, where it is.
# kubernetes.sh tries them on a cluster.
source "$(dirname "$0")/common.sh"
python3 -c 'import yaml' 2>/dev/null || skip "needs python3-yaml"
manifests=$CAIRN_SOURCE/deploy/kubernetes
version=$(cairn --version | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -n 1)
look() { python3 "$CAIRN_SOURCE/tests/end_to_end/kubernetes_manifests.py" "$version" "$@"; }

mapfile -t files < <(find "$manifests" -name '*.yaml')
exits 0 look "${files[@]}"

# It finds what is wrong.
# wrong PATTERN SED: the coordinator's manifest, changed.
wrong() {
  sed "$2" "$manifests/coordinator/coordinator.yaml" >wrong.yaml
  exits 1 look wrong.yaml "$manifests"/coordinator/network.yaml "$manifests"/worker-pod.yaml
  says "$1"
}
wrong 'runs as root' 's/runAsNonRoot: true/runAsNonRoot: false/'
wrong 'has capabilities' 's/capabilities: .*/capabilities: {}/'
wrong 'no memory in its limits' 's/limits: {cpu: "2", memory: 4Gi}/limits: {cpu: "2"}/'
wrong 'no option --stoer' 's/--store/--stoer/'
wrong 'no option --kye' 's/--key,/--kye,/'
wrong 'no livenessProbe' 's/livenessProbe/other/'
wrong 'selects no pod' 's/selector: {app.kubernetes.io.name: cairn-coordinator}/selector: {app: other}/'
wrong 'mounted' 's/- {name: tmp, mountPath.*//'

if ! command -v kubectl >/dev/null; then
  echo "kubectl is not here: not looked at what it makes of them"
  exit 0
fi
# Debian's kubectl is older than folders among `resources`.
minor=$(kubectl version --client -o json 2>/dev/null | grep -oE '"minor": *"[0-9]+' | grep -oE '[0-9]+$' || echo 0)
if [ "$minor" -lt 21 ]; then
  echo "kubectl 1.$minor is too old for these manifests: not looked at what it makes of them"
  exit 0
fi
for folder in . coordinator autoscaled autoscaled-by-work; do
  exits 0 kubectl kustomize "$manifests/$folder"
  cp stdout made.yaml
  exits 0 look made.yaml "$manifests/worker-pod.yaml"
  grep -q "image: cairn:$version" made.yaml || [ $folder = coordinator ] || die "no image cairn:$version in $folder"
done
