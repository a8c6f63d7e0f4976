# Sourced by tests with machines of their own: network namespaces with wires between them, which end with the test, and all
# that runs there. Needs root and ip.
# shellcheck shell=bash disable=SC2154
[ "$(id -u)" -eq 0 ] || skip "needs root to make network namespaces"
command -v ip >/dev/null || skip "needs ip (iproute2)"
machines=()
space() { echo "cairn-$$-$1"; }

# machine NAME: its namespace is `space NAME`.
machine() {
  ip netns add "$(space "$1")" 2>/dev/null || skip "may not make network namespaces here"
  machines+=("$1")
  ip -n "$(space "$1")" link set lo up
}

# wire NAME DEVICE ADDRESS NAME DEVICE ADDRESS: between two machines; an end without an address (-) gets none.
wire() {
  ip link add "$2" netns "$(space "$1")" type veth peer name "$5" netns "$(space "$4")" 2>/dev/null ||
    skip "may not make links here"
  local name device address
  while read -r name device address; do
    [ "$address" = - ] || ip -n "$(space "$name")" addr add "$address" dev "$device" 2>/dev/null ||
      skip "may not set addresses here"
    ip -n "$(space "$name")" link set "$device" up
  done <<<"$1 $2 $3"$'\n'"$4 $5 $6"
}

# on NAME COMMAND…: in that machine's network.
on() {
  local name=$1
  shift
  ip netns exec "$(space "$name")" "$@"
}

# What a test adds: it runs before the machines go, with the exit code, and after.
before_leaving() { :; }
after_leaving() { :; }
leave() {
  local code=$? name
  set +e  # one process that ends by itself between two looks must not keep the others
  before_leaving "$code"
  for name in "${machines[@]}"; do # what runs there is no child of this shell, but of `ip`
    ip netns pids "$(space "$name")" 2>/dev/null | xargs -r kill -9 2>/dev/null
    ip netns del "$(space "$name")" 2>/dev/null
  done
  after_leaving
  (exit "$code")
  cleanup
}
trap leave EXIT
