#!/usr/bin/env python3
"""How fast `cairn import bag` reads bags of ROS 1, beside rosbag's reader in Python, and in how much memory.

    tests/bench/bag_rate.py FOLDER GB [camera|lidar|laser|cloud …]     # all four

Makes in FOLDER, by Debian's python3-rosbag, bags of GB each, unless they are there: of a drive with a camera (rgb8 of 640 x 480, 30 a second), with
clouds of points, and of a laser alone; odometry, tf and scans are in each. Then both read odometry, tf and scans of each in turns, the best of
five: rosbag by read_messages(topics=…), which decodes each message and keeps none; cairn with all it does, up to the log's file. Seconds are of the
processor, of all processes; memory is that of the largest process. CAIRN: the program, build/release/bin/cairn without it.
"""
import array
import math
import os
import sys

ROUNDS = 5
TOPICS = ["/odom", "/tf", "/scan"]


def points():
    """60,000 of x, y, z and intensity: 16 rings of a lidar that stands in a hall of 20 m by 12 m, 4 m high."""
    rows = array.array("f")
    for ring in range(16):
        slope = math.tan(math.radians(2 * ring - 15))
        for step in range(3750):
            angle = 2 * math.pi * step / 3750
            c, s = math.cos(angle), math.sin(angle)
            reach = min(10 / max(abs(c), 1e-9), 6 / max(abs(s), 1e-9), (2.5 if slope > 0 else 1.5) / max(abs(slope), 1e-9))
            rows.extend((reach * c, reach * s, reach * slope, 0.5))
    return rows.tobytes()


def make(path, gigabytes, kind):
    import genpy
    import rosbag
    from geometry_msgs.msg import TransformStamped
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Image, LaserScan, PointCloud2, PointField
    from tf2_msgs.msg import TFMessage

    def stamp(message, frame):
        message.header.stamp, message.header.frame_id = time, frame
        return message

    def transform(parent, child, x, heading):
        one = stamp(TransformStamped(), parent)
        one.child_frame_id = child
        one.transform.translation.x = x
        one.transform.rotation.z, one.transform.rotation.w = math.sin(heading / 2), math.cos(heading / 2)
        return one

    image = Image(height=480, width=640, encoding="rgb8", step=1920, data=os.urandom(921600))
    fields = [PointField(name, 4 * i, 7, 1) for i, name in enumerate(("x", "y", "z", "intensity"))]
    cloud = PointCloud2(height=1, width=60000, fields=fields, point_step=16, row_step=960000, data=points(), is_dense=True)
    with rosbag.Bag(path + ".part", "w") as bag:
        tick = 0
        while bag.size < gigabytes * 1e9:
            time = genpy.Time(1700000000 + tick // 300, tick % 300 * 1000000000 // 300)
            heading = tick / 6000  # in a circle of 10 m
            if tick % 6 == 0:
                odometry = stamp(Odometry(), "odom")
                odometry.child_frame_id = "base_link"
                odometry.pose.pose.position.x, odometry.pose.pose.position.y = 10 * math.sin(heading), 10 * (1 - math.cos(heading))
                odometry.pose.pose.orientation.z, odometry.pose.pose.orientation.w = math.sin(heading / 2), math.cos(heading / 2)
                bag.write("/odom", odometry, time)
                bag.write("/tf", TFMessage([transform("base_link", "laser", 0.2, 0), transform("map", "odom", 0, 0)]), time)
            if tick % 30 == 0:
                scan = stamp(LaserScan(), "laser")
                scan.angle_min, scan.angle_increment, scan.range_max = -math.pi * 0.75, math.pi * 1.5 / 1080, 30.0
                scan.ranges = [1 + (i * 37 + tick) % 400 / 10 for i in range(1081)]
                bag.write("/scan", scan, time)
            if kind == "camera" and tick % 10 == 0:
                bag.write("/camera", stamp(image, "camera"), time)
            if kind == "lidar" and tick % 30 == 0:
                bag.write("/points", stamp(cloud, "laser"), time)
            tick += 2
    os.rename(path + ".part", path)


def peer(path, with_clouds="", with_points=""):
    import rosbag
    from sensor_msgs import point_cloud2
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages(topics=TOPICS + [with_clouds] * bool(with_clouds)):
            if topic == with_points:
                for _ in point_cloud2.read_points(message, ("x", "y", "z")):
                    pass


def run(arguments):
    """Seconds of the processor, and MB of the largest process."""
    child = os.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.dup2(1, 2)
        os.execv(arguments[0], arguments)
    _, status, usage = os.wait4(child, 0)
    if status != 0:
        sys.exit(f"{' '.join(arguments)}: failed")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6


def main():
    folder, gigabytes = sys.argv[1], float(sys.argv[2])
    cairn = os.environ.get("CAIRN", "build/release/bin/cairn")
    for kind in sys.argv[3:] or ["camera", "lidar", "laser", "cloud"]:
        made_as = "lidar" if kind == "cloud" else kind
        path = os.path.join(folder, f"{made_as}-{gigabytes:g}.bag")
        if not os.path.exists(path):
            make(path, gigabytes, made_as)
        options, more = (["--scan", "/scan", "--scan", "/points", "--cloud=-0.3,0.3,30"], ["/points"]) if kind == "cloud" else ([], [])
        log = path + ".h5"
        ours, theirs, memory = [], [], 0
        for _ in range(ROUNDS):
            seconds, most = run([cairn, "import", "bag", path, log, "--force", *options])
            ours.append(seconds)
            memory = max(memory, most)
            theirs.append(run([sys.executable, __file__, "peer", path, *more])[0])
        size = os.path.getsize(path) / 1e6
        print(f"{kind}: {size:.0f} MB; cairn {min(ours):.2f} s, {size / min(ours):.0f} MB/s, {memory:.0f} MB of memory, a log of "
              f"{os.path.getsize(log) / 1e6:.0f} MB; rosbag {min(theirs):.2f} s: {min(theirs) / min(ours):.1f} times", flush=True)
        if kind == "cloud":
            seconds = run([sys.executable, __file__, "peer", path, "/points", "/points"])[0]
            print(f"cloud, points too: rosbag {seconds:.2f} s: {seconds / min(ours):.1f} times")
        os.remove(log)


if sys.argv[1] == "peer":
    peer(*sys.argv[2:])
else:
    main()
