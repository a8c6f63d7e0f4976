#!/usr/bin/env bash
# check_image.sh ARCHIVE NAME:TAG FOLDER [PROGRAMS]: makes a map in that image, as its own user, on a root file system that nobody can
# write and without a network; then, where podman runs and kubectl is here, a job on the pods of deploy/kubernetes as podman's containers.
# PROGRAMS: the folder of those that the image was made of. For image.sh --check.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
archive=$1 name=$2 folder=$3 programs=${4:-}
install -d -m 700 -o 10001 -g 10001 "$folder/data"

podman=(podman --root "$folder/podman" --runroot "$folder/podman-run")
with_podman() { "${podman[@]}" "$@"; }
# in_podman WORD…: `cairn WORD…`, in a folder that outlives it.
in_podman() {
  with_podman run --rm --network none --read-only --cap-drop all --security-opt no-new-privileges --volume "$folder/data:/mnt" \
    --workdir /mnt --ulimit nofile=1024:1024 --ulimit nproc=4096:4096 "localhost/$name" "$@"
}
# The same by the kernel's own means.
# shellcheck disable=SC2016 # for the shell in there
in_unpacked() {
  unshare --mount --net --ipc --uts --pid --fork sh -euc '
    root=$1 data=$2
    shift 2
    mount --bind "$root" "$root"
    mount --rbind /dev "$root/dev"
    mount -t proc proc "$root/proc"
    mount -t tmpfs tmpfs "$root/tmp"
    mount --bind "$data" "$root/mnt"
    mount -o remount,bind,ro "$root"
    exec chroot "$root" setpriv --reuid 10001 --regid 10001 --clear-groups --no-new-privs --bounding-set=-all \
      env -i PATH=/usr/bin:/bin HOME=/home/map LANG=C.UTF-8 sh -euc "cd /mnt; ! touch /usr/x 2>/dev/null; exec cairn \"\$@\"" sh "$@"
  ' sh "$folder/unpacked" "$folder/data" "$@"
}
unpack() {
  local layer
  layer=$(tar -tvf "$archive" | sort -n -k 3 | tail -n 1 | awk '{print $NF}')
  mkdir "$folder/unpacked"
  tar -xOf "$archive" "$layer" | tar -xz --numeric-owner -C "$folder/unpacked"
}

how=in_unpacked
if command -v podman >/dev/null; then
  with_podman load -q -i "$archive" >/dev/null || fail "podman cannot read the image"
  with_podman images --format '{{.Repository}}:{{.Tag}} {{.Size}}' >&2
  for runtime in '' runc crun; do # some systems let only one of them run
    [ -z "$runtime" ] || podman+=(--runtime "$runtime")
    ! in_podman --version >/dev/null 2>"$folder/log" || { how=in_podman; break; }
    say "podman can run nothing here${runtime:+ by $runtime} ($(tail -n 1 "$folder/log"))"
  done
else
  say "podman is not here"
fi
if [ $how = in_podman ]; then
  say "trying it with podman"
else
  say "trying the unpacked system, by chroot and unshare: not as an engine for containers would"
  unpack
fi
"$how" simulate loop --difficulty base --robots 4 --seed 1 loop.h5
"$how" map loop.h5 --out loop >"$folder/log" 2>&1 || { cat "$folder/log" >&2; fail "no map"; }
"$how" evaluate loop --truth loop.h5 >"$folder/log"
grep -E '^(landmarks.found|landmarks.rmse_m|topology.correct) ' "$folder/log" >&2
grep -qE '^landmarks.found +20 of 20' "$folder/log" || fail "not all landmarks were found"
[ "$(stat -c %u "$folder/data/loop.h5")" = 10001 ] || fail "it runs as another user than 10001"

if [ $how = in_podman ] && [ -n "$programs" ] && command -v kubectl >/dev/null; then
  say "trying the pods of deploy/kubernetes with podman"
  CAIRN_BIN=$programs CAIRN_SOURCE=$root CAIRN_PODMAN="${podman[*]}" CAIRN_POD_IMAGE=localhost/$name \
    bash tests/faults/scale_kubernetes_test.sh || fail "the pods of deploy/kubernetes do not run"
fi
! command -v podman >/dev/null || with_podman rmi -f "localhost/$name" >/dev/null
