# Sourced by tests that need a Slurm cluster: three nodes and a controller, each in namespaces of its own (network, processes,
# host name), with munge. Everything lies in $cluster, which all of them see. Needs root.
# shellcheck shell=bash disable=SC2154
source "${CAIRN_SOURCE:?}/tests/faults/namespaces.sh"
cluster=$(mktemp -d "${TMPDIR:-/tmp}/cairn-slurm-XXXXXX")
before_leaving() { [ "$1" -eq 0 ] || tail -n 20 ./*.log "$cluster"/*.log >&2; }
after_leaving() {
  [ ! -e "$cluster/munged.pid" ] || kill -9 "$(cat "$cluster/munged.pid")" 2>/dev/null || true
  rm -rf "$cluster"
}

# within NAME COMMAND…: in that machine's namespaces of network and host name.
within() {
  local name=$1
  shift
  nsenter --net="/run/netns/$(space "$name")" unshare --uts sh -c 'hostname "$0"; exec "$@"' "$name" "$@"
}

machine hub
ip -n "$(space hub)" link add bridge type bridge 2>/dev/null || skip "may not make links here"
ip -n "$(space hub)" addr add 10.99.0.1/24 dev bridge
ip -n "$(space hub)" link set bridge up
for n in 1 2 3; do
  machine "cn$n"
  wire hub "wire$n" - "cn$n" wire "10.99.0.1$n/24"
  ip -n "$(space hub)" link set "wire$n" master bridge
done

dd if=/dev/urandom of="$cluster/munge.key" bs=1 count=1024 status=none
chmod 400 "$cluster/munge.key"
chmod 755 "$cluster"
munged --force --key-file="$cluster/munge.key" --socket="$cluster/munge.socket" --pid-file="$cluster/munged.pid" \
  --log-file="$cluster/munged.log" --seed-file="$cluster/munged.seed"
export SLURM_CONF=$cluster/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=test
SlurmctldHost=hub(10.99.0.1)
SlurmUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$cluster/munge.socket,cred_expire=5
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool-%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
ReturnToService=2
SlurmdTimeout=3
MessageTimeout=3
KillWait=2
OverTimeLimit=0
MailProg=/bin/true
NodeName=cn1 NodeAddr=10.99.0.11 CPUs=2 RealMemory=1000 State=UNKNOWN
NodeName=cn2 NodeAddr=10.99.0.12 CPUs=2 RealMemory=1000 State=UNKNOWN
NodeName=cn3 NodeAddr=10.99.0.13 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES State=UP
CONF
start_controller() { within hub slurmctld -D >>"$cluster/slurmctld.log" 2>&1 & }
declare -A node
# start_node NAME: killing ${node[NAME]} kills it with all that runs on it.
start_node() {
  nsenter --net="/run/netns/$(space "$1")" unshare --pid --fork --kill-child=KILL --mount-proc --uts \
    sh -c 'hostname "$0"; exec slurmd -D -N "$0" -c' "$1" >>"$cluster/slurmd-$1.log" 2>&1 &
  node[$1]=$!
}
start_controller
for n in 1 2 3; do start_node "cn$n"; done
on_hub() { within hub "$@"; }
idle_nodes() { on_hub sinfo -h -N -o %t 2>/dev/null | grep -c idle || true; }
all_idle() { [ "$(idle_nodes)" -eq 3 ]; }
until_true 30 all_idle
