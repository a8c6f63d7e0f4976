#!/usr/bin/env bash
# Installs the Debian packages that Cairn is built from; nothing where they are all there.
#
#   deploy/install.sh          what the build and the release tests need
#   deploy/install.sh --dev    also what ./deploy/test.sh --all needs: clang-format, clang-tidy, h5py, OctoMap, mypy
#   deploy/install.sh --arm64  also what ./deploy/arm64.sh needs: a cross compiler, qemu-user
#   deploy/install.sh --cluster  also what the tests of ssh, Slurm and Kubernetes need, daemons among it: sshd, munged, slurmctld, slurmd
#   deploy/install.sh --browser  also what the test of the pages needs: Chromium and its driver (132 MB to fetch), nginx
#   deploy/install.sh --list   installs nothing, prints the packages of the first line
#
# Runs as root, or as a user with sudo. The lists below are the whole of it: cmake/CairnDependencies.cmake finds the
# same libraries, and fails with their names where one is missing.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

build_packages=(
  g++ cmake ninja-build pkg-config protobuf-compiler
  libprotobuf-dev libeigen3-dev libzmq3-dev cppzmq-dev libhdf5-dev libsqlite3-dev libxxhash-dev
  libbz2-dev liblz4-dev libzstd-dev
  libmicrohttpd-dev libjemalloc-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libapriltag-dev
  libfmt-dev libspdlog-dev libcli11-dev libyaml-cpp-dev nlohmann-json3-dev zlib1g-dev libgtest-dev
  patch # Simulation.PlantedBugsApply
)
arm64_packages=(g++-aarch64-linux-gnu qemu-user)
dev_packages=(
  clang-19 libclang-rt-19-dev clang-format-19 clang-tidy-19 ccache git
  python3 python3-h5py python3-matplotlib python3-xxhash mypy # EndToEnd.python
  liboctomap-dev python3-yaml python3-pil # read back what is exported
  python3-rosbag python3-nav-msgs python3-sensor-msgs # EndToEnd.bag: write what is imported
  iproute2 nftables # tests/faults: networks that fail
  qemu-user # EndToEnd.cpu: a CPU below the build's target
  prometheus # EndToEnd.monitoring: promtool checks the rules and the page, a real one scrapes it
  lintian zsh # EndToEnd.package: Debian's checker, with dpkg-dev and man-db; completion
)

cluster_packages=(openssh-server openssh-client iproute2 slurmctld slurmd slurm-client slurm-wlm-basic-plugins munge)
# Another's kubectl is as good, and dpkg would not put this one in its place.
command -v kubectl >/dev/null || cluster_packages+=(kubernetes-client)

browser_packages=(chromium chromium-driver nginx-light openssl python3)

packages=("${build_packages[@]}")
for argument in "$@"; do
  case $argument in
    --dev) packages+=("${dev_packages[@]}") ;;
    --arm64) packages+=("${arm64_packages[@]}") ;;
    --cluster) packages+=("${cluster_packages[@]}") ;;
    --browser) packages+=("${browser_packages[@]}") ;;
    --list) printf '%s\n' "${build_packages[@]}"; exit 0 ;;
    -h | --help) sed -n '2,12s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$argument'; allowed: --dev, --arm64, --cluster, --browser, --list" ;;
  esac
done

command -v apt-get >/dev/null && command -v dpkg-query >/dev/null ||
  fail "no apt-get here; install these, or what your system calls them: ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
  # A package that was removed but left its settings is known to dpkg too, so the state is asked for.
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "run this as root, or install sudo; missing: ${missing[*]}"
  as_root=(sudo)
fi
say "installing ${missing[*]}"
apt_get() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Dpkg::Use-Pty=0 "$@" </dev/null >&2; }
apt_get update
apt_get install -y --no-install-recommends "${missing[@]}"
