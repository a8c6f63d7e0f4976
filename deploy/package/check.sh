# shellcheck shell=bash
# Within a bare Debian, as root: installs Cairn's packages CAIRN and IMAGES, makes the README's first map as the services' user,
# purges them. For package.sh --check.
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive
package=$1 images=$2 started=$SECONDS work=$(mktemp -d)

die() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}

apt-get -q update >/dev/null
apt-get -q -y install "$package" >"$work"/log 2>&1 || { cat "$work"/log; die "it cannot be installed"; }
grep -E 'newly installed|Need to get|disk space' "$work"/log
installed=$SECONDS
echo "installed after $((installed - started)) s"

as_cairn() { runuser -u cairn -- env -i HOME=/var/lib/cairn PATH=/usr/bin:/bin bash -euc "cd && $1"; }
as_cairn 'cairn simulate loop --difficulty base --robots 4 --seed 1 loop.h5
  cairn map loop.h5 --out loop >map.log 2>&1 || { cat map.log; exit 1; }
  cairn evaluate loop --truth loop.h5' >"$work"/map.log || die "no map"
grep -E '^(landmarks.found|landmarks.rmse_m|topology.correct) ' "$work"/map.log
echo "a map $((SECONDS - installed)) s later"
grep -qE '^landmarks.found +20 of 20' "$work"/map.log || die "not all landmarks were found"

# What decodes images is a package of its own.
code=0
apt-get -q -y install "$images" >"$work"/log 2>&1 || { cat "$work"/log; die "cairn-images cannot be installed"; }
grep -E 'newly installed|Need to get|disk space' "$work"/log
cairn-images >"$work"/log 2>&1 || code=$?
[ $code -eq 2 ] && grep -q SIDE "$work"/log || { cat "$work"/log; die "cairn-images does not run"; }
code=0
cairn-tags >"$work"/log 2>&1 || code=$?
[ $code -eq 2 ] && grep -q FAMILY "$work"/log || { cat "$work"/log; die "cairn-tags does not run"; }
apt-get -q -y purge cairn-images >"$work"/log 2>&1 || { cat "$work"/log; die "cairn-images cannot be purged"; }

# The rest of what may lie about: keys, a setting that was changed, services that are enabled.
as_cairn 'cairn keys new worker' >/dev/null
echo 'CAIRN_COORDINATOR=tcp://hub:7017' >>/etc/cairn/worker.env
mkdir -p /etc/systemd/system/multi-user.target.wants
ln -s /lib/systemd/system/cairn-worker@.service /etc/systemd/system/multi-user.target.wants/cairn-worker@1.service
apt-get -q -y remove cairn >"$work"/log 2>&1 || { cat "$work"/log; die "it cannot be removed"; }
grep -q hub /etc/cairn/worker.env || die "its settings went with its removal"
[ -s /var/lib/cairn/.config/cairn/worker.key ] || die "the keys went with its removal"
apt-get -q -y purge cairn >"$work"/log 2>&1 || { cat "$work"/log; die "it cannot be purged"; }

left=$(find / -xdev \( -iname '*cairn*' -not -name Pitcairn -o -nouser -o -nogroup \) -not -path "$package" -not -path "$images" -print)
[ -z "$left" ] || die "purged, it leaves behind: $left"
! getent passwd cairn || die "purged, it leaves a user behind"
! getent group cairn || die "purged, it leaves a group behind"
! dpkg-query -W cairn 2>/dev/null || die "purged, dpkg still knows it"
