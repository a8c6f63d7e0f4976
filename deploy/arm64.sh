#!/usr/bin/env bash
# Builds Cairn for arm64 on another machine, and runs its unit tests there under qemu-user.
#
#   deploy/arm64.sh              the programs, in build/arm64/bin, and the unit tests
#   deploy/arm64.sh --no-tests   the programs alone
#
# build/arm64/qemu/cairn then runs them here: `build/arm64/qemu/cairn run …` starts its workers under qemu-user too.
# The arm64 packages are unpacked into build/arm64-sysroot and not installed: this machine's own stay as they are.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

tests=true
for argument in "$@"; do
  case $argument in
    --no-tests) tests=false ;;
    -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$argument'; allowed: --no-tests" ;;
  esac
done

sysroot=$root/build/arm64-sysroot

# An apt of its own, which knows of no installed package: it fetches all that ours depend on, down to libc.
unpack_packages() {
  local apt=$sysroot.apt package link
  rm -rf "$apt" "$sysroot.new"
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$sysroot.new/usr/lib/aarch64-linux-gnu"
  touch "$apt/status"
  cat >"$apt/apt.conf" <<END
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Install-Recommends "false";
APT::Sandbox::User "";
Dir::State "$apt";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
END
  local -a packages
  mapfile -t packages < <(deploy/install.sh --list | grep -- '-dev$')
  export APT_CONFIG=$apt/apt.conf
  apt-get -q update >&2
  apt-get -q -y install --download-only libc6-dev libstdc++-12-dev "${packages[@]}" >&2
  unset APT_CONFIG
  ln -s usr/lib "$sysroot.new/lib"
  for package in "$apt"/cache/archives/*.deb; do dpkg-deb -x "$package" "$sysroot.new"; done
  # libm.so and its like name their target by a path from the root.
  while IFS= read -r -d '' link; do
    ln -sfrT "$sysroot.new$(readlink "$link")" "$link"
  done < <(find "$sysroot.new/usr/lib" -type l -lname '/*' -print0)
  # Where installing would have set Debian's alternatives: OpenCV needs both.
  for package in blas lapack; do
    ln -s "$package/lib$package.so.3" "$sysroot.new/usr/lib/aarch64-linux-gnu/lib$package.so.3"
  done
  rm -rf "$apt"
  mv "$sysroot.new" "$sysroot"
}

# `cairn` starts the cairn-worker beside it, and this machine cannot start an arm64 program: a script stands there.
write_runners() {
  local folder=build/arm64/qemu
  mkdir -p "$folder/programs"
  ln -f build/arm64/bin/cairn "$folder/programs/cairn"
  printf '#!/bin/sh\nexec qemu-aarch64 -L %q %q "$@"\n' "$sysroot" "$root/build/arm64/bin/cairn-worker" \
    >"$folder/programs/cairn-worker"
  printf '#!/bin/sh\nexec qemu-aarch64 -L %q %q "$@"\n' "$sysroot" "$root/$folder/programs/cairn" >"$folder/cairn"
  chmod +x "$folder/programs/cairn-worker" "$folder/cairn"
}

deploy/install.sh --arm64
if [ ! -d "$sysroot" ]; then
  say "unpacking arm64 packages"
  unpack_packages
fi
say "building (arm64)"
deploy/build.sh arm64 cairn cairn-worker
write_runners
if $tests; then
  deploy/build.sh arm64 cairn_unit_tests
  ctest --test-dir build/arm64 --output-on-failure --no-tests=error --parallel "$(cairn_jobs)"
fi
