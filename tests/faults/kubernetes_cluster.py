"""A cluster of this machine's processes, for kubectl: python3 kubernetes_cluster.py PORT FOLDER

Serves as much of Kubernetes' interface as `cairn scale kubernetes` uses by kubectl: pods and Secrets that are made, listed and
deleted, garbage collected with their owner. A pod is a process of its container `worker`, its Secret a folder, in place of what
the template's other container copies. No scheduler, no images, no rights: that takes a real cluster. With CAIRN_POD_IMAGE a pod is
podman's containers of that image, with the rights and limits of its manifest (podman_pod.py).
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import urllib.parse
import uuid
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import podman_pod

PORT, FOLDER = int(sys.argv[1]), pathlib.Path(sys.argv[2])
LOCK = threading.Lock()
THERE = {"pods": {}, "secrets": {}}  # by name
RUNNING = {}  # processes, by the pod's name
KINDS = {"pods": "Pod", "secrets": "Secret"}
RESOURCES = {"kind": "APIResourceList", "groupVersion": "v1", "resources": [
    {"name": name, "singularName": name[:-1], "namespaced": True, "kind": kind, "verbs": ["create", "delete", "list"]}
    for name, kind in KINDS.items()]}
FIXED = {
    "/api": {"kind": "APIVersions", "versions": ["v1"]},
    "/apis": {"kind": "APIGroupList", "apiVersion": "v1", "groups": []},
    "/api/v1": RESOURCES,
    "/version": {"major": "1", "minor": "32", "gitVersion": "v1.32.0"},
    "/openapi/v2": None,  # nothing that kubectl could hold fields against
}


def begin_ready_pods():
    """A pod waits for its Secret, as it would be for its volume."""
    for name, pod in THERE["pods"].items():
        volumes = [v["secret"]["secretName"] for v in pod["spec"]["volumes"] if "secret" in v]
        if name in RUNNING or not all(v in THERE["secrets"] for v in volumes):
            continue
        keys = FOLDER / name
        keys.mkdir(mode=0o700)
        for volume in volumes:
            for file, text in THERE["secrets"][volume]["stringData"].items():
                (keys / file).touch(mode=0o600)
                (keys / file).write_text(text)
        worker = next(c for c in pod["spec"]["containers"] if c["name"] == "worker")
        words = [word.replace("/keys/own", str(keys)) for word in worker["command"] + worker["args"]]
        with open(FOLDER / f"{name}.log", "w") as log:
            if podman_pod.IMAGE:
                RUNNING[name] = podman_pod.start(pod["spec"], keys, FOLDER / f"{name}-data", FOLDER / f"{name}-pod", name, log)
            else:
                RUNNING[name] = subprocess.Popen(words, stdout=log, stderr=log)
        pod["status"] = {"phase": "Running"}
        pod["spec"]["nodeName"] = "here"


def look_at_processes():
    for name, process in list(RUNNING.items()):
        code = process.poll()
        pod = THERE["pods"].get(name)
        if code is None or pod is None:
            continue
        if "deletionTimestamp" in pod["metadata"]:
            remove(name)
            continue
        said = (FOLDER / f"{name}.log").read_text()[-1000:]
        ended = {"exitCode": code if code >= 0 else 128 - code, "reason": "Error" if code else "Completed", "message": said}
        pod["status"] = {"phase": "Failed" if code else "Succeeded",
                         "containerStatuses": [{"name": "worker", "state": {"terminated": ended}}]}


def remove(name):
    uid = THERE["pods"].pop(name)["metadata"]["uid"]
    for secret, value in list(THERE["secrets"].items()):
        if any(owner["uid"] == uid for owner in value["metadata"].get("ownerReferences", [])):
            del THERE["secrets"][secret]


def failure(code, reason, message):
    return code, {"kind": "Status", "apiVersion": "v1", "status": "Failure", "code": code, "reason": reason, "message": message}


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def answer(self, code, value):
        data = json.dumps(value).encode() if value else b""
        self.send_response(code)
        self.send_header("Content-Type", "application/json" if value else "application/octet-stream")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def serve(self, of_resource):
        url = urllib.parse.urlparse(self.path)
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        parts = url.path.strip("/").split("/")
        with LOCK:
            look_at_processes()
            if url.path in FIXED:
                return self.answer(200, FIXED[url.path])
            if parts[:2] != ["api", "v1"] or len(parts) < 5 or parts[4] not in KINDS:
                return self.answer(*failure(404, "NotFound", "the server could not find the requested resource"))
            self.answer(*of_resource(parts[4], parts[5] if len(parts) > 5 else "", urllib.parse.parse_qs(url.query), body))

    def list(self, what, _name, query, _body):
        label, _, value = query.get("labelSelector", ["="])[0].partition("=")
        some = [one for one in THERE[what].values() if one["metadata"].get("labels", {}).get(label) == value]
        return 200, {"kind": KINDS[what] + "List", "apiVersion": "v1", "metadata": {}, "items": some}

    def create(self, what, _name, _query, body):
        one = json.loads(body)
        name = one["metadata"]["name"]
        if what == "pods" and len(THERE["pods"]) >= 3:
            return failure(403, "Forbidden", f'pods "{name}" is forbidden: exceeded quota: three')
        if name in THERE[what]:
            return failure(409, "AlreadyExists", f'{what} "{name}" already exists')
        one["metadata"].update(uid=str(uuid.uuid4()), namespace="default")
        if what == "pods":
            one["status"] = {"phase": "Pending"}
        THERE[what][name] = one
        begin_ready_pods()
        return 201, one

    def delete(self, what, name, _query, _body):
        if name not in THERE[what]:
            return failure(404, "NotFound", f'{what} "{name}" not found')
        one = THERE[what][name]
        if what == "secrets":
            del THERE[what][name]
        elif name in RUNNING and RUNNING[name].poll() is None:
            one["metadata"]["deletionTimestamp"] = "2026-01-01T00:00:00Z"
            RUNNING[name].send_signal(signal.SIGTERM)
        else:
            remove(name)
        return 200, one

    def do_GET(self):
        self.serve(self.list)

    def do_POST(self):
        self.serve(self.create)

    def do_DELETE(self):
        self.serve(self.delete)

    def log_message(self, form, *arguments):
        print(form % arguments, flush=True)


(FOLDER / "pid").write_text(f"{os.getpid()}\n")
ThreadingHTTPServer(("127.0.0.1", PORT), Handler).serve_forever()
