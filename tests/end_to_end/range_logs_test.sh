#!/usr/bin/env bash
# Recorded range logs, as docs/datasets.md reads them in; and a CARMEN log made on the spot.
source "$(dirname "$0")/common.sh"

# A robot that drives 3 m through a corridor, old messages, poses corrected afterwards.
awk 'BEGIN {
  print "# CARMEN Logfile"; print "PARAM robot_front_laser_max 20 0 host 0"; print "NEFF 20"
  for (i = 0; i <= 30; i++) {
    x = 0.1 * i; t = 100 + 0.5 * i
    printf "ODOM %g 0 0 0.2 0 0 %g host %g\n", x - 0.01, t - 0.2, t - 0.2
    printf "FLASER 181"
    for (b = 0; b <= 180; b++) { s = sin((b - 90) * atan2(0, -1) / 180); if (s < 0) s = -s; r = s > 0.05 ? 1 / s : 25; printf " %.2f", r }
    printf " %g 0 0 %g 0 0 %g host %g\n", x, x, t, t
  }
}' >corridor.log
exits 0 cairn import carmen corridor.log corridor.h5
says '^cairn: warning: its poses are taken for corrected ones'
says '^cairn: read 31: FLASER$'
says '^cairn: left out 1: NEFF'
says '^corridor.h5: 1 robot, [0-9]+ controls, 0 observations, 31 range scans, 62 poses$'
refuses "'corridor.h5' is there already" cairn import carmen corridor.log corridor.h5
exits 0 cairn inspect corridor.h5
says '31 scans of 181 beams \(laser\), 62 poses'
exits 0 cairn import carmen corridor.log raw.h5 --raw
says '^raw.h5: 1 robot, [0-9]+ controls, 0 observations, 31 range scans$'
exits 0 cairn import carmen corridor.log again.h5 --json
[ "$(number FLASER stdout)" -eq 31 ] || die "not told as JSON: $(cat stdout)"
same_bits corridor.h5 again.h5
exits 0 cairn export tum corridor.h5 tum
[ "$(grep -c '^[0-9]' tum/robot.tum)" -eq 62 ] || die "not every pose went out"
exits 0 cairn import tum tum/robot.tum poses.h5
says '^poses.h5: 1 robot, 62 poses$'
exits 0 cairn inspect poses.h5
says '^  robot robot +62 poses over 15.2 s$'
printf '1 0 0 0\n0.5 0 0 0\n' >back.tum
refuses 'back.tum:2: time does not run forward' cairn import tum back.tum back.h5
exits 0 cairn import tum back.tum back.h5 --skip-bad --robot Rosa
says '^cairn: skipped 1: time does not run forward$'
refuses "OUT.h5 is required" cairn import tum tum/robot.tum tum/robot.tum
# 1 m and back, as somebody measured it, by a clock that is 1000 s ahead.
printf '1101 1106 1 0 0 0 0 0\n1106 1101 -1 0 0 0 0 0.1\n5 6 0 0 0 0 0 0\n' | gzip >corridor.relations.gz
exits 0 cairn evaluate corridor.h5 --relations corridor.relations.gz --offset-s 1000 --json
below "$(number translation_m stdout)" 1e-9
[ "$(number scored stdout)" -eq 2 ] && [ "$(number outside stdout)" -eq 1 ] || die "other relations: $(cat stdout)"
exits 0 cairn evaluate poses.h5 --relations corridor.relations.gz --offset-s 1000
says '^relations.rotation_deg +2.86 degrees on average'
refuses 'no relation lies within the time of the poses' cairn evaluate raw.h5 --relations corridor.relations.gz
refuses 'neither --truth nor --feature' cairn evaluate raw.h5 --relations corridor.relations.gz --truth raw.h5
refuses 'offset-s requires --relations' cairn evaluate raw.h5 --offset-s 3
printf '1 2 3\n' >bad.relations
refuses 'bad.relations:1: wrong number of values' cairn evaluate raw.h5 --relations bad.relations

[ -n "${CAIRN_DATA:-}" ] && [ -d "$CAIRN_DATA/carmen-intel" ] || skip "CAIRN_DATA names no folder that holds carmen-intel"
runs_section 'CARMEN'
for line in 'intel.h5: .* 910 range scans, 11148 poses' 'intel-raw.h5: .* 910 range scans' \
  'fr079.h5: .* 4791 range scans, 4934 poses' 'fhw.h5: .* 488 range scans, 13447 poses' \
  'belgioioso.h5: .* 395 range scans, 4837 poses'; do
  grep -Eq "^$line\$" said || die "not read as '$line': $(cat said)"
done
runs_section 'Other range logs'
for line in 'pioneer1.h5: .* 826 range scans' 'loop5.h5: .* 551 range scans' 'wean1.h5: .* 713 range scans'; do
  grep -Eq "^$line\$" said || die "not read as '$line': $(cat said)"
done
rm -r poses.h5
runs_section 'Trajectories'
grep -q '^poses.h5: 1 robot, 11148 poses$' said || die "other poses: $(cat said)"
# Corrected poses that stand beside the raw log, given by a file.
exits 0 cairn import tum "$CAIRN_DATA/carmen-intel/intel-corrected-poses.txt.gz" beside.h5 --robot robot
exits 0 cairn evaluate beside.h5 --relations "$CAIRN_DATA/carmen-intel/intel.relations.gz" --json
below "$(number translation_m stdout)" 0.13

# A map of the raw log at poses from elsewhere stands where they say, and not where odometry does.
for map in 'raw' 'placed --input poses=beside.h5'; do
  read -ra words <<<"$map"
  exits 0 cairn run evidence_map intel-raw.h5 --out "${words[@]}" --set cell_m=0.2
  exits 0 cairn evaluate "${words[0]}" --relations "$CAIRN_DATA/carmen-intel/intel.relations.gz" --json
  number translation_m stdout >"${words[0]}.error"
done
below "$(cat placed.error)" 0.13
below 7 "$(cat raw.error)"
