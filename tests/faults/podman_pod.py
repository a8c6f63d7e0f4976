"""A pod of Kubernetes as containers of podman's: users, rights, environment, limits and volumes as its manifest says.

As a program it runs a StatefulSet's pod until it is told to go, as a node would:

    python3 podman_pod.py MANIFEST SECRET DATA

SECRET: the folder that is the pod's Secret. DATA: that of its volume. Its containers share this machine's network. Once its start-up
probe has passed it prints `ready`; told to go (SIGTERM) it tells the container, and ends as that does. CAIRN_PODMAN is podman's
command with options of its own, CAIRN_POD_IMAGE the image.
"""

import json
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import time

PODMAN = shlex.split(os.environ.get("CAIRN_PODMAN", "podman"))
IMAGE = os.environ.get("CAIRN_POD_IMAGE")
MEGABYTES = {"Mi": 1, "Gi": 1024}


def words(spec, container, volumes, name):
    """The command that runs one of the pod's containers. `volumes`: a folder for each volume, by name."""
    user, own = spec["securityContext"], container["securityContext"]
    limits = container["resources"]["limits"]
    assert user["runAsNonRoot"] and own["readOnlyRootFilesystem"] and own["capabilities"] == {"drop": ["ALL"]}
    assert own["allowPrivilegeEscalation"] is False and user["seccompProfile"]["type"] == "RuntimeDefault"
    memory = limits["memory"]
    run = ["run", "--rm", "--name", name, "--network", "host", "--user", f"{user['runAsUser']}:{user['runAsGroup']}", "--read-only",
           "--read-only-tmpfs=false", "--cap-drop", "all", "--security-opt", "no-new-privileges", "--memory",
           f"{int(memory[:-2]) * MEGABYTES[memory[-2:]]}m", "--cpus", limits["cpu"], "--ulimit", "nofile=1024:1024", "--ulimit",
           "nproc=4096:4096"]
    for variable in container.get("env", []):
        run += ["--env", f"{variable['name']}={variable['value']}"]
    for mount in container["volumeMounts"]:
        run += ["--volume", f"{volumes[mount['name']]}:{mount['mountPath']}" + (":ro" if mount.get("readOnly") else "")]
    if "command" in container:
        run += ["--entrypoint", json.dumps(container["command"])]
    return [*PODMAN, *run, IMAGE, *container.get("args", [])]


def folders(spec, secret, data, where):
    """A folder for each volume: the Secret's files are root's and its group's to read, the others the group's."""
    group, made = spec["securityContext"]["fsGroup"], {}
    for volume in [*spec.get("volumes", []), {"name": "data"}]:
        folder = data if volume["name"] == "data" else where / volume["name"]
        if "secret" in volume:
            folder.mkdir()
            for file in secret.iterdir():
                (folder / file.name).write_bytes(file.read_bytes())
                (folder / file.name).chmod(volume["secret"]["defaultMode"])
                os.chown(folder / file.name, 0, group)
        else:
            folder.mkdir(exist_ok=True)
            folder.chmod(0o770)
        os.chown(folder, 0, group)
        made[volume["name"]] = folder
    return made


def start(spec, secret, data, where, name, log):
    """Runs the init containers to their ends and begins the only other one, as a process that passes signals on."""
    where.mkdir()
    where.chmod(0o755)
    volumes = folders(spec, secret, data, where)
    for k, container in enumerate(spec["initContainers"]):
        subprocess.run(words(spec, container, volumes, f"{name}-init-{k}"), check=True, stdout=log, stderr=log)
    (container,) = spec["containers"]
    return subprocess.Popen(words(spec, container, volumes, name), stdout=log, stderr=log)


def main(manifest, secret, data):
    import yaml
    with open(manifest) as text:
        spec = next(one for one in yaml.safe_load_all(text) if one["kind"] == "StatefulSet")["spec"]["template"]["spec"]
    name = f"cairn-coordinator-{os.getpid()}"
    process = start(spec, pathlib.Path(secret), pathlib.Path(data), pathlib.Path(data + f"-{os.getpid()}"), name, sys.stderr)
    told = []

    def tell(number, _frame):
        told.append(time.monotonic())
        process.send_signal(number)
    signal.signal(signal.SIGTERM, tell)
    (container,) = spec["containers"]
    asked = [*PODMAN, "exec", name, *container["startupProbe"]["exec"]["command"]]
    while subprocess.run(asked, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode != 0:
        if process.poll() is not None:
            sys.exit(f"the container has ended: {process.returncode}")
        time.sleep(1)
    print("ready", flush=True)
    code = process.wait()
    if told and time.monotonic() - told[0] > spec["terminationGracePeriodSeconds"]:
        sys.exit(f"it took {time.monotonic() - told[0]:.0f} s to go")
    sys.exit(code)


if __name__ == "__main__":
    main(*sys.argv[1:])
