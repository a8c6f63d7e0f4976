#!/usr/bin/env python3
"""A bag of ROS 1 by Debian's python3-rosbag, of what robots have beside odometry and scans: make_robot_bag.py OUT.bag

A robot stands for 3 s, drives a quarter of a circle of 4 m radius in 10 s, of which its odometry says that it is a straight line, and stands
again: a gyro of a bias of 0.02 rad/s, the joints of its wheels, fixes, poles that it saw. Its fellow in the namespace /bob does the same.
"""
import math
import sys

import genpy
import rosbag
from geometry_msgs.msg import Pose, PoseArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState, NavSatFix

RADIUS_M, TURN_S, STAND_S, BIAS = 4.0, 10.0, 3.0, 0.02
LENGTH_M = RADIUS_M * math.pi / 2


def share(t):
    return min(max((t - STAND_S) / TURN_S, 0.0), 1.0)


def place(t):
    angle = share(t) * math.pi / 2
    return RADIUS_M * math.sin(angle), RADIUS_M * (1 - math.cos(angle)), angle


def stamped(message, t, frame):
    message.header.stamp, message.header.frame_id = genpy.Time.from_sec(1e9 + t), frame
    return message


def odometry(t):
    message = stamped(Odometry(), t, "odom")
    message.child_frame_id = "base_link"
    message.pose.pose.position.x, message.pose.pose.orientation.w = LENGTH_M * share(t), 1
    return message


def gyro(t):
    message = stamped(Imu(), t, "base_link")
    message.angular_velocity.z = BIAS + (math.pi / 2 / TURN_S if STAND_S <= t <= STAND_S + TURN_S else 0)
    return message


def joints(t):
    angle = share(t) * math.pi / 2
    message = stamped(JointState(), t, "")
    message.name = ["arm", "left", "right"]
    message.position = [1, angle * (RADIUS_M - 0.25) / 0.1, angle * (RADIUS_M + 0.25) / 0.1]
    return message


def fix(t):
    x, y, _ = place(t)
    message = stamped(NavSatFix(), t, "base_link")
    message.status.status = -1 if 6 < t < 8 else 0
    message.latitude, message.longitude = y / 110574.27, x / 111319.49  # at the equator, east is ahead
    return message


def poles(t):
    x, y, angle = place(t)
    message = stamped(PoseArray(), t, "base_link")
    for east, north in ((6, 1), (2, 5)):
        seen = Pose()
        dx, dy = east - x, north - y
        seen.position.x = math.cos(angle) * dx + math.sin(angle) * dy
        seen.position.y = -math.sin(angle) * dx + math.cos(angle) * dy
        message.poses.append(seen)
    return message


def main():
    with rosbag.Bag(sys.argv[1], "w", compression="bz2") as bag:
        for i in range(1601):
            t = 0.01 * i
            for robot in ("/anna", "/bob"):
                bag.write(robot + "/imu", gyro(t), genpy.Time.from_sec(1e9 + t))
                if i % 10:
                    continue
                for topic, make in (("/odom", odometry), ("/joints", joints), ("/fix", fix), ("/poles", poles)):
                    bag.write(robot + topic, make(t), genpy.Time.from_sec(1e9 + t))


main()
