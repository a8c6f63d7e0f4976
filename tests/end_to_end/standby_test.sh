#!/usr/bin/env bash
# A second machine takes a store over from one that was lost: it is asked first, goes on to the same bits, and the first, should
# it come back, writes nothing more. The first machine is a name and a boot id of its own, in namespaces.
source "$(dirname "$0")/common.sh"

echo 11111111-1111-1111-1111-111111111111 >boot_id
# A command that follows is run on hub1.
hub1=(unshare -r -u -m bash -c 'hostname hub1 && mount --bind "$0" /proc/sys/kernel/random/boot_id && exec "$@"' "$work/boot_id")
"${hub1[@]}" true 2>/dev/null || skip "no namespaces here"

simulate log.h5
settings=(--set starts=40) # else it may be done before anybody has looked
exits 0 cairn run landmark_map log.h5 --out undisturbed --workers 1 "${settings[@]}"
serve() {
  "$@" cairn coordinator --checkpoint-rounds 1 --store shared ${take_over:-} >>coordinator.log 2>&1 &
  coordinator=$!
  until_true 20 cairn list >/dev/null
}
serve "${hub1[@]}"
exits 0 cairn submit landmark_map log.h5 --json "${settings[@]}"
id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
cairn worker >worker.log 2>&1 &
worked() { cairn status "$id" --json >status.json && [ "$(number round status.json)" -gt 2 ]; }
until_true 60 worked
cp shared/holder firsts
grep -q ' serves hub1 ' firsts || die "the store does not say who serves it: $(cat firsts)"
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true

# Not by itself: nobody knows that the first is off.
refuses 'served last by hub1 \(process [0-9]+\), which did not give it back: make sure that this one is off, then start with --take-over' \
  cairn coordinator --store shared
cmp -s firsts shared/holder || die "a coordinator that was refused has changed the store"
take_over=--take-over serve env
exits 0 cairn watch "$id"
exits 0 cairn results "$id" --out there
same_bits undisturbed there

# Given back, it is anybody's; and on the machine that had it nothing need be said, however it ended.
kill -9 "$coordinator"
wait "$coordinator" 2>/dev/null || true
serve env
kill "$coordinator"
wait "$coordinator"
grep -q ' gave-back ' shared/holder || die "a coordinator that ended in order did not give the store back"
serve "${hub1[@]}"
kill "$coordinator"
wait "$coordinator"

# Another takes over from one that lives on, cut off: it says so, ends, and acknowledges nothing meanwhile.
serve env
cp firsts shared/holder
! cairn submit landmark_map log.h5 --seed 9 >stdout 2>stderr || die "it acknowledges what the other would not find"
code=0
wait "$coordinator" || code=$?
[ "$code" -eq 2 ] || die "it ended with $code"
grep -q 'shared: another coordinator has taken the store over' coordinator.log || die "it does not say why it ends"
cmp -s firsts shared/holder || die "it has written, though the store was another's"
