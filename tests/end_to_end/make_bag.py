#!/usr/bin/env python3
"""A CARMEN log as a bag of ROS 1, by Debian's python3-rosbag, and as a CARMEN log of the same numbers.

make_bag.py LOG OUT.bag OUT.log [none|bz2|lz4]

ODOM and FLASER lines count, and of FLASER the pose too. A bag has ranges of four bytes and headings as quaternions, so the CARMEN log that is
written beside it has what became of them.
"""
import gzip
import math
import struct
import sys

import genpy
import rosbag
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def heading(z, w):
    return math.atan2(2 * (w * z + 0.0), 1 - 2 * (0.0 + z * z))


def time_of(text):
    seconds, _, fraction = text.partition(".")
    return genpy.Time(int(seconds), int((fraction + "000000000")[:9]))


def odometry(seq, x, y, theta, stamp):
    message = Odometry()
    message.header.seq, message.header.stamp, message.header.frame_id = seq, stamp, "odom"
    message.child_frame_id = "base_link"
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
    return message


def scan(seq, ranges, stamp):
    message = LaserScan()
    message.header.seq, message.header.stamp, message.header.frame_id = seq, stamp, "base_link"
    step = math.pi / 180 * (180 / len(ranges) if len(ranges) % 2 == 0 else 180 / (len(ranges) - 1))
    message.angle_min, message.angle_increment = single(-math.pi / 2), single(step)
    message.angle_max = single(message.angle_min + (len(ranges) - 1) * step)
    message.range_max = 50.0
    message.ranges = [single(r) for r in ranges]
    return message


def main():
    source, bag_name, log_name = sys.argv[1:4]
    packed = sys.argv[4] if len(sys.argv) > 4 else "none"
    opened = gzip.open(source, "rt") if source.endswith(".gz") else open(source)
    seq = 0
    with opened as lines, rosbag.Bag(bag_name, "w", compression=packed, chunk_threshold=20000) as bag, open(log_name, "w") as log:
        for line in lines:
            words = line.split()
            if not words or words[0] not in ("ODOM", "FLASER"):
                continue
            stamp = time_of(words[-3])
            seq += 1
            at = f"{stamp.secs}.{stamp.nsecs:09d}"
            beams = int(words[1]) if words[0] == "FLASER" else 0
            first = 2 + beams + 3 if beams else 1
            x, y, theta = (float(w) for w in words[first:first + 3])
            pose = (x, y, heading(math.sin(theta / 2), math.cos(theta / 2)))
            bag.write("/odom", odometry(seq, x, y, theta, stamp), stamp)
            log.write("ODOM {!r} {!r} {!r} 0 0 0 {} h {}\n".format(*pose, at, at))
            if not beams:
                continue
            ranges = [float(w) for w in words[2:2 + beams]]
            message = scan(seq, ranges, stamp)
            bag.write("/scan", message, stamp)
            log.write("RAWLASER1 0 {!r} {!r} {!r} 50 0 0 {} {} 0 {} h {}\n".format(
                message.angle_min, message.angle_increment * (len(ranges) - 1), message.angle_increment, len(ranges),
                " ".join(map(repr, message.ranges)), at, at))


main()
