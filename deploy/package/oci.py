#!/usr/bin/env python3
"""Makes an OCI image of one layer, as an archive, of a root file system's tar: image.sh calls it.

The format is that of the OCI image specification 1.0: a layout of blobs called by their SHA-256. The same input gives the same
bytes.
"""

import argparse
import gzip
import hashlib
import io
import json
import shutil
import tarfile
import tempfile
import time

CONFIG = "application/vnd.oci.image.config.v1+json"
LAYER = "application/vnd.oci.image.layer.v1.tar+gzip"
MANIFEST = "application/vnd.oci.image.manifest.v1+json"


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", help="tar of the root file system")
    parser.add_argument("archive")
    parser.add_argument("--name", required=True, help="NAME:TAG")
    parser.add_argument("--version", required=True)
    parser.add_argument("--epoch", type=int, required=True)
    parser.add_argument("--architecture", required=True)
    return parser.parse_args()


def sha256(file):
    digest = hashlib.sha256()
    for block in iter(lambda: file.read(1 << 20), b""):
        digest.update(block)
    return digest.hexdigest()


class Layout:
    """An archive that is written from front to back."""

    def __init__(self, path, epoch):
        self.tar = tarfile.open(path, "w", format=tarfile.USTAR_FORMAT)
        self.epoch = epoch

    def add(self, name, file, size):
        entry = tarfile.TarInfo(name)
        entry.size, entry.mtime, entry.mode = size, self.epoch, 0o644
        self.tar.addfile(entry, file)

    def add_json(self, name, value):
        data = json.dumps(value, sort_keys=True).encode()
        self.add(name, io.BytesIO(data), len(data))

    def add_blob(self, media_type, file):
        file.seek(0)
        digest = sha256(file)
        size = file.tell()
        file.seek(0)
        self.add("blobs/sha256/" + digest, file, size)
        return {"mediaType": media_type, "digest": "sha256:" + digest, "size": size}


def main():
    arguments = read_arguments()
    created = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(arguments.epoch))
    layout = Layout(arguments.archive, arguments.epoch)
    with open(arguments.root, "rb") as root, tempfile.TemporaryFile() as packed:
        unpacked = sha256(root)
        root.seek(0)
        with gzip.GzipFile(fileobj=packed, mode="wb", compresslevel=6, mtime=0, filename="") as stream:
            shutil.copyfileobj(root, stream, 1 << 20)
        layer = layout.add_blob(LAYER, packed)
    config = {
        "created": created,
        "architecture": arguments.architecture,
        "os": "linux",
        "config": {
            "User": "10001:10001",
            "Entrypoint": ["cairn"],
            "Cmd": ["--help"],
            "Env": ["PATH=/usr/bin:/bin", "HOME=/home/map", "LANG=C.UTF-8"],
            "WorkingDir": "/home/map",
            "Labels": {
                "org.opencontainers.image.title": "cairn",
                "org.opencontainers.image.version": arguments.version,
                "org.opencontainers.image.licenses": "Apache-2.0",
            },
        },
        "rootfs": {"type": "layers", "diff_ids": ["sha256:" + unpacked]},
        "history": [{"created": created, "created_by": "deploy/image.sh"}],
    }
    config = layout.add_blob(CONFIG, io.BytesIO(json.dumps(config, sort_keys=True).encode()))
    manifest = {"schemaVersion": 2, "mediaType": MANIFEST, "config": config, "layers": [layer]}
    manifest = layout.add_blob(MANIFEST, io.BytesIO(json.dumps(manifest, sort_keys=True).encode()))
    manifest["annotations"] = {"org.opencontainers.image.ref.name": arguments.name}
    layout.add_json("oci-layout", {"imageLayoutVersion": "1.0.0"})
    layout.add_json("index.json", {"schemaVersion": 2, "manifests": [manifest]})
    layout.tar.close()


if __name__ == "__main__":
    main()
