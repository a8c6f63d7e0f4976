#!/usr/bin/env bash
# The simulated office: a turret of sonars, its local map scored, shown and used for a grid map at its poses.
source "$(dirname "$0")/common.sh"

exits 0 cairn simulate office --minutes 4 --seed 103 office.h5
says '1200 scans over 240 s'
exits 0 cairn inspect office.h5
says 'robot/0/sonar/turret_rad'
refuses 'minutes.*0.5' cairn simulate office --minutes 0.5 no.h5
refuses 'there already' cairn simulate office office.h5

exits 0 cairn run local_map office.h5 --out result --workers 2
exits 0 cairn evaluate result --truth office.h5 --json
for name in odometry_rmse_m error_deg found wrong; do
  number $name stdout | grep -qE '^[0-9]' || die "evaluate does not say $name: $(cat stdout)"
done
awk -v path="$(grep -m1 '"rmse_m"' stdout | tr -dc '0-9.')" -v raw="$(number odometry_rmse_m stdout)" \
  'BEGIN {exit !(path > 0 && path < raw && path < 0.3)}' || die "the path is no better than odometry: $(cat stdout)"
exits 0 cairn report result --log office.h5 --out page.html
[ "$(grep -o '<figure' page.html | wc -l)" -ge 5 ] || die "the page lacks pictures"
exits 0 cairn export tum result path
[ "$(grep -c '^[0-9]' path/robot_0.tum)" -eq 1200 ] || die "the path is not a pose a scan: $(head -3 path/robot_0.tum)"
exits 0 cairn simulate office --minutes 4 --seed 104 other.h5
refuses 'made from another log' cairn evaluate result --truth other.h5

# Sonars that are read as if they did not turn with their turret make no map of the walls.
mkdir maps
exits 0 cairn run evidence_map office.h5 --set sensors=infrared --set cell_m=0.1 --input poses=result/local_map.h5 --out maps/infrared
exits 0 cairn evaluate maps/infrared --truth office.h5 --json
awk -v off="$(number pose_rmse_m stdout)" 'BEGIN {exit !(off < 0.3)}' || die "its poses are not local_map's: $(cat stdout)"
