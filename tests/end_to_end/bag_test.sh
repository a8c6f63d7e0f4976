#!/usr/bin/env bash
# Bags that programs which are not ours have written: what is made of them is what is made of the same numbers in a
# CARMEN log, to the bit.
source "$(dirname "$0")/common.sh"

/usr/bin/python3 -c 'import rosbag, nav_msgs.msg, sensor_msgs.msg' 2>/dev/null ||
  skip "Debian's python3-rosbag, python3-nav-msgs and python3-sensor-msgs are not installed"
awk 'BEGIN {
  for (i = 0; i <= 60; i++) {
    t = sprintf("%.6f", 1000000000 + 0.25 * i)
    printf "FLASER 181"
    for (b = 0; b <= 180; b++) { s = sin((b - 90) * atan2(0, -1) / 180); if (s < 0) s = -s; r = s > 0.05 ? 1 / s : 60; printf " %.2f", r }
    printf " %g 0 %g %g 0 %g %s h %s\n", 0.1 * i, 0.01 * i, 0.1 * i, 0.01 * i, t, t
  }
}' >drive.log
for packing in none bz2 lz4; do
  /usr/bin/python3 "$CAIRN_SOURCE/tests/end_to_end/make_bag.py" drive.log $packing.bag same.log $packing
  exits 0 cairn import bag $packing.bag $packing.h5
  says '^cairn: read 61: messages of /scan$'
  says "^$packing.h5: 1 robot, [0-9]+ controls, 0 observations, 61 range scans$"
done
exits 0 cairn import carmen same.log same.h5
for packing in none bz2 lz4; do same_bits same.h5 $packing.h5; done
refuses 'first make a log of it: cairn import bag none.bag log.h5' cairn map none.bag
refuses 'there is no such topic; the nearest' cairn import bag none.bag x.h5 --odometry /odm
refuses 'OUT.h5 is required' cairn import bag none.bag
refuses "--mount /scna: there is no such topic; the nearest: '/scan'" cairn import bag none.bag x.h5 --mount /scna=0,0,0
refuses '--mount is said twice of /scan' cairn import bag none.bag x.h5 --mount /scan=0,0,0 --mount /scan=1,0,0
exits 0 cairn import bag none.bag --mount /scan=0,0,0 mounted.h5 --scan /scan  # each takes one
head -c 100000 none.bag >cut.bag
refuses 'the file ends within it' cairn import bag cut.bag cut.h5
exits 0 cairn import bag cut.bag cut.h5 --skip-bad
says '^cairn: skipped 1: part of a file that cannot be read$'
head -c 20000 none.bag >cut.bag
exits 0 cairn import bag cut.bag part.h5 --skip-bad
says '^cairn: read [1-9][0-9]*: messages of /odom$'  # within the chunk that is not whole
exits 0 cairn map none.h5 --dry-run
exits 0 cairn inspect cut.bag
says 'scan sensor_msgs.LaserScan: [0-9]+ messages, .* as scans$'

# What robots have beside odometry and scans: the odometry of this one says that it drives straight on.
/usr/bin/python3 "$CAIRN_SOURCE/tests/end_to_end/make_robot_bag.py" robots.bag
exits 0 cairn inspect robots.bag
says 'anna/joints sensor_msgs.JointState: 161 messages, .* as odometry of two wheels, with --wheels$'
says 'anna/fix sensor_msgs.NavSatFix: .* as true positions, with --truth$'
poles=poles:x=poses.position.x,y=poses.position.y
robots=(--robots "anna,bob" --odometry odom --landmarks "$poles" --truth fix)
exits 0 cairn import bag robots.bag straight.h5 "${robots[@]}"
says '^straight.h5: 2 robots, [0-9]+ controls, 644 observations$'
says '^cairn: left out [0-9]+: messages of /anna/fix without a fix$'
exits 0 cairn import bag robots.bag gyro.h5 "${robots[@]}" --gyro imu
says '/bob/imu: the odometry turns as this gyro does; its bias, measured in 2 halts of .* is 0.02000 to 0.02000 rad/s'
exits 0 cairn import bag robots.bag wheels.h5 --robots anna,bob --wheels left,right,0.1,0.5 --landmarks "$poles" --truth fix
says '/anna/joints and /anna/odom contradict each other: .* turns by 1.57 rad, the other 6.3 m and 0.00 rad'
turned() { cairn export csv "$1" "$1.csv" >/dev/null && awk -F, 'NR == 1 {for (i = 1; i <= NF; i++) at[$i] = i}
  NR > 1 && $at["robot"] == "bob" {turn += $at["turn_rad"]} END {printf "%.2f\n", turn}' "$1.csv/odometry.csv"; }
[ "$(turned straight.h5)" = 0.00 ] || die "the odometry turns by itself: $(turned straight.h5)"
for log in gyro wheels; do
  [ "$(turned $log.h5)" = 1.57 ] || die "$log turn by $(turned $log.h5) rad"
done
refuses "no field 'poses.x'; the nearest: " cairn import bag robots.bag x.h5 --robots anna --landmarks poles:x=poses.x,y=poses.y

# Bags of ROS 2, by @mcap/core and SQLite's shell, of a robot that drives straight on.
# CAIRN_NODE_MODULES: a folder with what make_ros2_bags.mjs needs, where they are to be made anew.
awk 'BEGIN {
  for (i = 0; i <= 30; i++) {
    t = sprintf("%.6f", 1000000000 + 0.25 * i)
    printf "FLASER 19"
    for (b = 0; b <= 18; b++) printf " %.2f", 1 + (7 * i + 3 * b) % 11 / 4
    printf " %g %g 0 %g %g 0 %s h %s\n", 0.1 * i, 0.03 * i, 0.1 * i, 0.03 * i, t, t
  }
}' >straight.log
/usr/bin/python3 "$CAIRN_SOURCE/tests/end_to_end/make_bag.py" straight.log ros1.bag same-straight.log
exits 0 cairn import carmen same-straight.log same-straight.h5
tar -xzf "$CAIRN_SOURCE/tests/end_to_end/ros2_bags.tar.gz"
if command -v node >/dev/null && [ -d "${CAIRN_NODE_MODULES:-}/@mcap/core" ]; then
  NODE_PATH=$CAIRN_NODE_MODULES node "$CAIRN_SOURCE/tests/end_to_end/make_ros2_bags.mjs" straight.log made-chunked.mcap made-plain.mcap made.sql
  for file in chunked.mcap plain.mcap; do cmp "$file" "made-$file" || die "ros2_bags.tar.gz has another $file"; done
  cmp drive.sql made.sql || die "ros2_bags.tar.gz has another drive.sql"
fi
bags=(ros1.bag chunked.mcap plain.mcap)
if command -v sqlite3 >/dev/null; then
  sqlite3 drive.db3 <drive.sql
  bags+=(drive.db3)
fi
for bag in "${bags[@]}"; do
  exits 0 cairn import bag "$bag" "$bag.h5"
  says '^cairn: read 31: messages of /scan$'
  same_bits same-straight.h5 "$bag.h5"
done

[ -n "${CAIRN_DATA:-}" ] && [ -d "$CAIRN_DATA/carmen-intel" ] || skip "CAIRN_DATA names no folder that holds carmen-intel"
/usr/bin/python3 "$CAIRN_SOURCE/tests/end_to_end/make_bag.py" "$CAIRN_DATA/carmen-intel/intel-raw.log.gz" intel.bag intel.log lz4
exits 0 cairn import bag intel.bag intel.h5
exits 0 cairn import carmen intel.log same-intel.h5
same_bits same-intel.h5 intel.h5
