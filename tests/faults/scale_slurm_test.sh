#!/usr/bin/env bash
# Workers on a real Slurm of three nodes: a node that is killed, and with --long also a controller that is started anew, an
# element that is cancelled and a time limit that comes: the same bits, no key and nothing in the queue in the end.
source "${CAIRN_SOURCE:?}/tests/end_to_end/common.sh"
command -v sbatch >/dev/null && command -v slurmctld >/dev/null && command -v slurmd >/dev/null &&
  command -v munged >/dev/null || skip "needs Slurm and munge (deploy/install.sh --cluster)"
source "$CAIRN_SOURCE/tests/faults/slurm_cluster.sh"
long=${1:-}

for name in coordinator client; do exits 0 cairn keys new "$name" --dir keys; done
exits 0 cairn keys allow keys/client.pub --as submitter --dir keys
service=(--connect tcp://10.99.0.1:7017 --key keys/client.key --server-key keys/coordinator.pub)
client() { local command=$1; shift; on_hub cairn "$command" "$@" "${service[@]}"; }
scale() {
  on_hub cairn scale slurm --max 4 --keys keys --work-s 0.01 --idle-s 1 --cool-down-s 0 --every-s 0.3 --drain-s "${drain_s:-20}" \
    --task-memory-mb 400 "${service[@]}" "$@"
}
simulate log.h5
exits 0 cairn run landmark_map log.h5 --set cell_m=0.2 --out here --workers 2
cell_m=0.2
on_hub cairn coordinator --store store --listen 'tcp://*:7017' --keys keys >hub.log 2>&1 &
until_true 20 client list >/dev/null
job() {
  printf 'name: %s\ninputs: {log: log.h5}\nstages: [{name: landmark_map, pipeline: landmark_map, log: log, options: {cell_m: %s}}]\n' \
    "$1" "$cell_m" >"$1.yaml"
  exits 0 client submit "$1.yaml" --json
  id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
}
connected() { [ "$(client list 2>/dev/null | grep -oE '^[0-9]+ workers?' | cut -d ' ' -f 1)" -ge "$1" ]; }
queued() { on_hub squeue -h -r | wc -l; }
# ends NAME: that job is done with the same bits, and all that was started for it is gone.
ends() {
  exits 0 client watch "$id"
  wait "$scaler" || die "scale ended with $?"
  exits 0 client results "$id" --out "$1"
  same_bits here "$1"
  [ "$(queued)" -eq 0 ] || die "still in the queue: $(on_hub squeue -r)"
  ! grep -q ' worker slurm-' keys/allowed || die "keys are left: $(cat keys/allowed)"
}

# What Slurm does not know is said as Slurm says it.
job first
scale --partition nowhere >scale.log 2>&1 &
scaler=$!
until_true 20 grep -q 'nvalid partition' scale.log
pkill -TERM -P "$scaler"
wait "$scaler" || die "scale ended with $?"
! grep -q ' worker slurm-' keys/allowed || die "keys of workers that were not begun: $(cat keys/allowed)"

# A node is killed with the workers that it has.
scale --until-done >scale.log 2>&1 &
scaler=$!
until_true 30 connected 2
kill -9 "${node[cn1]}"
ends node
[ -n "$long" ] || exit 0

start_node cn1
until_true 60 all_idle
# The controller is away for a while.
job second
scale --until-done >scale.log 2>&1 &
scaler=$!
until_true 30 connected 2
pkill -9 -F "$cluster/slurmctld.pid"
until_true 30 grep -q 'the engine cannot be asked' scale.log
start_controller
until_true 60 grep -q 'the engine answers again' scale.log
ends controller

# Somebody cancels an element: it drains, and another comes if there is work.
job third
scale --until-done >scale.log 2>&1 &
scaler=$!
until_true 30 connected 2
on_hub scancel "$(on_hub squeue -h -r -o %i | head -n 1)"
ends cancelled

# The time limit of a minute comes while they work: they are told to go before it, others come, and no attempt is lost.
cell_m=0.1
rm -r here
exits 0 cairn run landmark_map log.h5 --set cell_m=$cell_m --out here --workers 2
ids=()
for name in fourth fifth sixth seventh; do
  job "$name"
  ids+=("$id")
done
drain_s=5 scale --until-done --sbatch=--time=1 >scale.log 2>&1 &
scaler=$!
ends limit
[ "$(grep -c ' starts ' scale.log)" -ge 2 ] || die "the limit never came: $(cat scale.log)"
for id in "${ids[@]}"; do
  exits 0 client logs "$id"
  ! grep -Eq 'died|lost its connection' stdout || die "a worker was cut off: $(cat stdout)"
done

# For who may only submit jobs: the coordinator is a job, too. Its node is killed; it is queued anew and goes on.
exits 0 on_hub cairn run landmark_map log.h5 --set cell_m=$cell_m --on slurm --workers 2 --out alone
says "^submitted as Slurm's job [0-9]+; results come into $work/alone"
until_true 60 grep -q 'round 3' alone/.on-slurm/log
host=$(on_hub squeue -h -n cairn-alone -o %N)
kill -9 "${node[$host]}"
until_true 100 test -s alone/landmark_map.h5
all_done() { [ "$(queued)" -eq 0 ]; }
until_true 60 all_done
same_bits here alone
grep -q 'where it was\|at round' alone/.on-slurm/log || die "it did not go on: $(cat alone/.on-slurm/log)"
# Who cancels it ends its workers, too, and it does not come again.
exits 0 on_hub cairn run landmark_map log.h5 --set cell_m=$cell_m --seed 4 --on slurm --workers 2 --out never
until_true 60 grep -q 'round 3' never/.on-slurm/log
exits 0 on_hub scancel -n cairn-never
until_true 60 all_done
[ ! -e never/landmark_map.h5 ] || die "a job that was cancelled has a result"
