#!/usr/bin/env bash
# On a CPU below the build's target both programs say so plainly, before their first wide instruction.
source "$(dirname "$0")/common.sh"

command -v qemu-x86_64 >/dev/null || skip "no qemu-x86_64 here (Debian: qemu-user)"
cairn --version | grep -q 'x86-64-v3' || skip "this build has another target than x86-64-v3"
for program in cairn cairn-worker; do
  exits 2 qemu-x86_64 -cpu Nehalem "$CAIRN_BIN/$program" --version
  says '^cairn: this CPU is below x86-64-v3 .*-DCAIRN_MARCH=x86-64'
  exits 0 qemu-x86_64 -cpu Haswell "$CAIRN_BIN/$program" --version
done
