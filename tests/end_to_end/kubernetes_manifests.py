"""Looks through manifests for Kubernetes: python3 kubernetes_manifests.py VERSION FILE…

What must hold of all of them together: no container runs as root, may write its own file system, gain rights or take what it
likes; selectors select, mounts have their volume, `cairn` gets options that it knows. VERSION: of all images that have one.
"""

import pathlib
import re
import subprocess
import sys

import yaml

version, files = sys.argv[1], sys.argv[2:]
metrics = (pathlib.Path(__file__).parents[2] / "docs" / "monitoring.md").read_text()
complaints = []


def demand(holds, what):
    if not holds:
        complaints.append(what)


def documents():
    for file in files:
        for document in yaml.safe_load_all(open(file)):
            if document and document.get("kind") not in ("Kustomization", None):
                yield file.rsplit("/", 1)[-1], document


def known_options(command):
    said = subprocess.run([*command, "--help"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", said, re.MULTILINE))


def commands_of(words):
    """The words of a command of ours, without its options: cairn scale kubernetes."""
    ours = []
    for word in words:
        if not re.fullmatch(r"[a-z-]+", word) or word.startswith("-"):
            break
        ours.append(word)
    return ours


def look_at_command(who, words):
    if not words or words[0] not in ("cairn", "cairn-worker"):
        return
    known = known_options(commands_of(words))
    for word in words:
        option = word.split("=")[0]
        demand(not option.startswith("--") or option in known, f"{who}: there is no option {option}")


def look_at_container(who, container):
    bounds = container.get("securityContext", {})
    demand(bounds.get("allowPrivilegeEscalation") is False, f"{who}: may gain rights")
    demand(bounds.get("readOnlyRootFilesystem") is True, f"{who}: may write its root file system")
    demand(bounds.get("capabilities", {}) == {"drop": ["ALL"]}, f"{who}: has capabilities")
    demand(not bounds.get("privileged"), f"{who}: is privileged")
    for kind in ("requests", "limits"):
        for what in ("cpu", "memory"):
            demand(container.get("resources", {}).get(kind, {}).get(what), f"{who}: no {what} in its {kind}")
    tag = container["image"].partition(":")[2]
    demand(tag in ("", version), f"{who}: image {container['image']}, and this is {version}")
    look_at_command(who, container.get("command", ["cairn"]) + container.get("args", []))
    for probe in ("startupProbe", "readinessProbe", "livenessProbe"):
        demand(probe in container or container["name"] != "coordinator", f"{who}: no {probe}")
        demand("tcpSocket" not in container.get(probe, {}), f"{who}: a {probe} that is counted as refused")
        look_at_command(who, container.get(probe, {}).get("exec", {}).get("command"))


def look_at_pod(who, pod, claims=()):
    bounds = pod.get("securityContext", {})
    demand(bounds.get("runAsNonRoot") is True and bounds.get("runAsUser", 0) > 0, f"{who}: runs as root")
    demand(bounds.get("seccompProfile") == {"type": "RuntimeDefault"}, f"{who}: any system call")
    demand(pod.get("automountServiceAccountToken") is False, f"{who}: every container is let into the cluster")
    demand(not pod.get("hostNetwork") and not pod.get("hostPID"), f"{who}: is in the host's namespaces")
    containers = pod.get("initContainers", []) + pod["containers"]
    mounted = {m["name"] for c in containers for m in c.get("volumeMounts", [])}
    volumes = {v["name"] for v in pod.get("volumes", [])} | set(claims)
    demand(mounted == volumes, f"{who}: mounted {mounted}, there is {volumes}")
    demand(not any("hostPath" in v for v in pod.get("volumes", [])), f"{who}: mounts the host's files")
    for container in containers:
        look_at_container(f"{who}, {container['name']}", container)
        words = container.get("args", [])
        if "--drain-s" in words:
            drain = int(words[words.index("--drain-s") + 1])
            demand(pod["terminationGracePeriodSeconds"] >= drain + 15, f"{who}: killed while it drains")


labels, selectors, kinds = [], [], set()


def look_at(file, document):
    kind, spec = document["kind"], document.get("spec", {})
    who = f"{file}: {kind} {document['metadata'].get('name', '')}"
    kinds.add(kind)
    if kind == "Pod":
        labels.append(document["metadata"]["labels"])
        look_at_pod(who, spec)
    elif kind in ("StatefulSet", "Deployment"):
        if "selector" in spec:  # else it is a patch
            labels.append(spec["template"]["metadata"]["labels"])
            selectors.append((who, spec["selector"]["matchLabels"]))
            claims = [c["metadata"]["name"] for c in spec.get("volumeClaimTemplates", [])]
            look_at_pod(who, spec["template"]["spec"], claims)
        demand(kind != "StatefulSet" or spec.get("replicas", 1) == 1, f"{who}: a store has one coordinator")
    elif kind == "Service":
        selectors.append((who, spec["selector"]))
    elif kind == "PodDisruptionBudget":
        selectors.append((who, spec["selector"]["matchLabels"]))
    elif kind == "NetworkPolicy":
        selectors.append((who, spec["podSelector"]["matchLabels"]))
        demand(spec["policyTypes"] == ["Ingress", "Egress"], f"{who}: one way is open")
    elif kind == "HorizontalPodAutoscaler":
        for metric in spec["metrics"]:
            name = metric.get("external", {}).get("metric", {}).get("name")
            demand(name is None or f"`{name}`" in metrics, f"{who}: nobody shows {name}")
    elif kind == "Role":
        may = {resource: set(rule["verbs"]) for rule in document["rules"] for resource in rule["resources"]}
        demand(may == {"pods": {"create", "list", "delete"}, "secrets": {"create", "delete"}},
               f"{who}: more than is needed, or less: {may}")
    elif kind == "ConfigMap" and "worker-pod.yaml" in document["data"]:
        look_at("worker-pod.yaml in " + file, yaml.safe_load(document["data"]["worker-pod.yaml"]))


for file, document in documents():
    look_at(file, document)
for who, selector in selectors:
    demand(any(selector.items() <= one.items() for one in labels), f"{who}: selects no pod: {selector}")
for kind in ("StatefulSet", "Service", "PodDisruptionBudget", "NetworkPolicy"):
    demand(kind in kinds, f"no {kind} in {files}")
for line in complaints:
    print(line)
sys.exit(1 if complaints else 0)
