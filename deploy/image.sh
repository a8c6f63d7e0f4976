#!/usr/bin/env bash
# Makes an OCI image of Cairn: Debian's smallest system and the package cairn, nothing else; a user who is not root, `cairn` as
# what is run. Prints the archive, which `podman load`, `docker load` and `skopeo copy oci-archive:…` read.
#
#   deploy/image.sh              makes the package, then build/image/cairn-VERSION.tar
#   deploy/image.sh --kubectl    with kubectl besides, for `cairn scale kubernetes`: build/image/cairn-kubectl-VERSION.tar
#   deploy/image.sh --check      also makes a map in it as an ordinary user: with podman, where that can run something
#                                here, and the pods of deploy/kubernetes; else in the unpacked system, and says so
#
#   --package FILE   a package that is made already
#   --out DIR        where the archive goes, and beside it the list of its packages (default: build/image)
#   --folder DIR     where the system is made, 1 GB, until it is through (default: TMPDIR)
#   --suite NAME     of Debian (default: bookworm)
#
# Needs root and mmdebstrap.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

package='' programs='' out=$root/build/image check=false folder=${TMPDIR:-/tmp} suite=bookworm name=cairn more=()
while [ $# -gt 0 ]; do
  case $1 in
    --package | --out | --folder | --suite) [ $# -gt 1 ] || fail "$1 needs a value" ;;&
    --package) package=$(realpath -e -- "$2") || fail "there is no file '$2'"; shift 2 ;;
    --out) out=$(realpath -m -- "$2"); shift 2 ;;
    --folder) folder=$(realpath -m -- "$2"); shift 2 ;;
    --suite) suite=$2; shift 2 ;;
    --kubectl) name=cairn-kubectl more=(kubernetes-client); shift ;;
    --check) check=true; shift ;;
    -h | --help) sed -n '2,16s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$1'; allowed: --kubectl, --check, --package FILE, --out DIR, --folder DIR, --suite NAME" ;;
  esac
done
cd "$root"
[ "$(id -u)" -eq 0 ] || fail "needs root: it makes a system of its own"
for program in mmdebstrap python3; do
  command -v "$program" >/dev/null || fail "needs $program: apt-get install $program"
done

if [ -z "$package" ]; then
  made=$(deploy/package.sh --out "$root/build/package")
  package=${made%%$'\n'*} programs=$root/build/release/bin
fi
version=$(dpkg-deb -f "$package" Version)
version=${version%-*}
epoch=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
mkdir -p "$out" "$folder"
work=$(mktemp -d "$folder/cairn-image.XXXXXX")
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"

# What nobody reads in there: documents but for licences, other languages, apt's lists and its packages. What nothing there loads:
# OpenCV's core depends on OpenGL, that on drivers of graphics cards, those on a compiler. That all that our programs load is
# there is looked at below.
left_out=('/usr/share/'{man,locale,lintian}'/*' '/usr/lib/*/dri/*' '/usr/lib/*/lib'{LLVM,z3,icu}'*')
options=(--dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright')
for path in "${left_out[@]}"; do options+=(--dpkgopt="path-exclude=$path"); done
say "making a system ($suite)"
# shellcheck disable=SC2016 # $1 is mmdebstrap's
SOURCE_DATE_EPOCH=$epoch TMPDIR=$work mmdebstrap --variant=minbase "${options[@]}" \
  --include="$(IFS=,; echo "ca-certificates${more[*]:+,${more[*]}}")" \
  --customize-hook="copy-in '$package' /tmp" \
  --customize-hook='chroot "$1" sh -c "apt-get -q -o APT::Install-Recommends=false -y install /tmp/*.deb && rm /tmp/*.deb"' \
  --customize-hook='chroot "$1" sh -c "groupadd -g 10001 map && useradd -u 10001 -g 10001 -d /home/map -m map"' \
  --customize-hook='! chroot "$1" ldd /usr/bin/cairn /usr/bin/cairn-worker /usr/bin/cairn-reproduce | grep "not found" >&2' \
  --customize-hook="chroot \"\$1\" dpkg-query -W -f '\${Package} \${Version}\\n' >'$work/packages'" \
  --customize-hook='rm -rf "$1"/var/lib/apt/lists/* "$1"/var/cache/apt/* "$1"/var/cache/debconf/* "$1"/var/log/* "$1"/tmp/*' \
  "$suite" "$work/root.tar" >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "the system could not be made"; }

archive=$out/$name-$version.tar
say "packing"
python3 deploy/package/oci.py "$work/root.tar" "$archive" --name "$name:$version" --version "$version" --epoch "$epoch" \
  --architecture "$(dpkg --print-architecture)"
cp "$work/packages" "${archive%.tar}.packages"
echo "$archive"
printf '%s MB to pull, %s MB unpacked\n' "$(($(stat -c %s "$archive") / 1000000))" \
  "$(($(stat -c %s "$work/root.tar") / 1000000))" >&2
if $check; then
  rm "$work/root.tar"
  deploy/package/check_image.sh "$archive" "$name:$version" "$work" "$programs"
fi
