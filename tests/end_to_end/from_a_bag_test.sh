#!/usr/bin/env bash
# Follows docs/from-a-bag.md word by word: every command in its ```sh blocks; what it shows of a bag is what is printed.
source "$(dirname "$0")/common.sh"

page=$CAIRN_SOURCE/docs/from-a-bag.md
awk '/^```sh$/ {on = 1; next} /^```$/ {on = 0} on' "$page" >commands
[ "$(wc -l <commands)" -ge 9 ] || die "the page has lost its commands"
while IFS= read -r command; do
  bash -euc "$command" >stdout 2>stderr || die "the page's command failed: $command"
  case $command in
    *inspect*) cp stdout inspected ;;
    *"--out map") cp stdout mapped ;;
  esac
done <commands
for file in map/map.png map/report.html map/landmarks.h5 map-tables/landmarks.csv hall-map/map.png hall-ros/*.yaml; do
  [ -s "$file" ] || die "the page's commands did not make $file"
done
awk '/^```text$/ {on = 1; next} /^```$/ {on = 0} on' "$page" >shown
[ -s shown ] || die "the page shows nothing of a bag"
diff shown inspected >&2 || die "the page shows another bag than inspect"
grep -qE '^trajectory.rmse_m +0\.1[0-9]* m' mapped || die "the page's path lies elsewhere: $(grep rmse mapped)"

# The bag and the log that it was made of give maps of the same places.
exits 0 cairn inspect log.h5
says '510 observations, 3113 true poses'

# A bag is not replaced unasked, and is called one.
refuses 'drive.bag.*there already' cairn simulate loop --bag drive.bag other.h5
refuses "ends in .bag" cairn simulate loop --bag drive.mcap other.h5
[ ! -e other.h5 ] || die "a log was written beside a bag that was refused"

# Programs that are not ours read it.
/usr/bin/python3 -c 'import rosbag' 2>/dev/null || skip "Debian's python3-rosbag is not installed"
/usr/bin/python3 - >stdout 2>&1 <<'P' || die "rosbag cannot read it: $(cat stdout)"
import rosbag
counts = {}
with rosbag.Bag("hall.bag") as bag:
    for topic, message, stamp in bag.read_messages():
        counts[topic] = counts.get(topic, 0) + 1
        assert topic == "/tf_static" or message.header.stamp == stamp, topic
    for info in bag.get_type_and_topic_info().topics.items():
        assert counts[info[0]] == info[1].message_count, info
assert counts["/sonar_23"] == 75 and counts["/odom"] == 75, counts
P
grep -q . stdout && die "rosbag has something to say: $(cat stdout)"
exit 0
