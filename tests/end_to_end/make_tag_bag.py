"""A robot that drives twice round a room with AprilTags on its walls, and what its camera sees, as a bag of ROS 1.

  make_tag_bag.py PICTURES OUT.bag   PICTURES: a folder with libapriltag's picture of each tag, ID.png
  make_tag_bag.py --truth LOG.h5     puts the true places of the tags into what was made of it

Odometry errs by 3 % of its turns and 1 % of the way. Images are drawn twice as large through a camera with distortion, and made smaller.
"""
import io
import math
import random
import sys

import numpy as np

random.seed(8)
SIZE = 0.2  # the edge of a tag's black square, 8 of its 10 cells
FX, FY, CX, CY, WIDTH, HEIGHT, FINER = 420.0, 425.0, 315.0, 243.0, 640, 480, 2
K1, K2, P1, P2 = -0.12, 0.03, 0.001, -0.0007
MOUNT = (0.15, 0.05, math.radians(-60))  # it looks to the right, where the walls are
# x, y, height above the camera, and where it faces
TAGS = [(-2.6, -3, 0.1, 90), (-0.4, -3, -0.1, 90), (2, -3, 0.05, 90), (4, -1.4, 0.1, 180), (4, 1.1, 0, 180), (2.4, 3, -0.1, 270), (0.1, 3, 0.1, 270),
        (-2.2, 3, 0.05, 270), (-4, 1.3, 0, 0), (-4, -1, -0.05, 0)]


def drive():
    x, y, heading = -2.0, -1.5, 0.0
    for gx, gy in [(2, -1.5), (2.5, 1.5), (-2.2, 1.5), (-2.5, -1.5)] * 2:
        while math.hypot(gx - x, gy - y) > 0.4:
            turn = math.remainder(math.atan2(gy - y, gx - x) - heading, 2 * math.pi)
            heading += max(-0.15, min(0.15, turn))
            x, y = x + 0.1 * math.cos(heading), y + 0.1 * math.sin(heading)
            yield x, y, heading


def distorted(u, v):
    r2 = u * u + v * v
    radial = 1 + K1 * r2 + K2 * r2 * r2
    return u * radial + 2 * P1 * u * v + P2 * (r2 + 2 * u * u), v * radial + P1 * (r2 + 2 * v * v) + 2 * P2 * u * v


def undistorted_rays():
    """Of each fine pixel: the ray on z = 1 that it sees."""
    step = (np.arange(FINER) + 0.5) / FINER - 0.5
    px = (np.arange(WIDTH)[:, None] + step).ravel()
    py = (np.arange(HEIGHT)[:, None] + step).ravel()
    du, dv = np.meshgrid((px - CX) / FX, (py - CY) / FY)
    u, v = du.copy(), dv.copy()
    for _ in range(15):
        eu, ev = distorted(u, v)
        u, v = u + du - eu, v + dv - ev
    return u, v


def view(rays, pictures, x, y, heading):
    """The room as the camera there sees it: grey, and the tags that face it."""
    u, v = rays
    c, s = math.cos(heading), math.sin(heading)
    ax, ay = x + c * MOUNT[0] - s * MOUNT[1], y + s * MOUNT[0] + c * MOUNT[1]
    look = heading + MOUNT[2]
    c, s = math.cos(look), math.sin(look)
    image = np.full(u.shape, 140, np.uint8)
    for (tx, ty, up, facing), picture in zip(TAGS, pictures):
        nx, ny = math.cos(math.radians(facing)), math.sin(math.radians(facing))
        to = (ax - tx) * nx + (ay - ty) * ny  # how far before its plane the camera is
        ahead = (tx - ax) * c + (ty - ay) * s
        if to <= 0.1 or ahead <= 0.3:
            continue
        # A ray of the camera, z ahead, x to the right: in the room ahead + right * u, up by -v.
        dx, dy = c + s * u, s - c * u
        toward = -(dx * nx + dy * ny)
        t = to / np.where(toward > 1e-6, toward, 1e-6)  # what looks away meets it a thousand kilometres off
        # On the tag, seen from before it: to the right is the facing turned by +90 degrees.
        right = (ax + t * dx - tx) * -ny + (ay + t * dy - ty) * nx
        down = up + t * v
        cell = SIZE / 8
        i, j = np.floor(right / cell + 5), np.floor(down / cell + 5)
        on = (i >= 0) & (i < 10) & (j >= 0) & (j < 10)
        image[on] = picture[j[on].astype(int), i[on].astype(int)]
    mean = image.reshape(HEIGHT, FINER, WIDTH, FINER).mean(axis=(1, 3))
    return np.clip(mean + NOISE.normal(0, 2, mean.shape), 0, 255).astype(np.uint8)


NOISE = np.random.default_rng(4)


def write_bag(folder, path):
    import genpy
    import rosbag
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Odometry
    from PIL import Image as Picture
    from sensor_msgs.msg import CameraInfo, CompressedImage, Image

    pictures = [np.array(Picture.open(f"{folder}/{i}.png").convert("L")) for i in range(len(TAGS))]
    rays = undistorted_rays()
    odometry = [0.0, 0.0, 0.0]
    before = None

    def place(pose, at):
        pose.position.x, pose.position.y = at[0], at[1]
        pose.orientation.z, pose.orientation.w = math.sin(at[2] / 2), math.cos(at[2] / 2)

    with rosbag.Bag(path, "w") as bag:
        for k, at in enumerate(drive()):
            stamp = genpy.Time(1000000000 + k // 5, k % 5 * 200000000)
            if before is not None:
                odometry[2] += 1.03 * math.remainder(at[2] - before[2], 2 * math.pi) + random.gauss(0, 0.003)
                way = 1.01 * math.hypot(at[0] - before[0], at[1] - before[1])
                odometry[0] += way * math.cos(odometry[2])
                odometry[1] += way * math.sin(odometry[2])
            before = at
            message = Odometry()
            message.header.stamp, message.header.frame_id, message.child_frame_id = stamp, "odom", "base_link"
            place(message.pose.pose, odometry)
            bag.write("/odom", message, stamp)
            message = PoseStamped()
            message.header.stamp, message.header.frame_id = stamp, "map"
            place(message.pose, at)
            bag.write("/truth", message, stamp)
            if k % 4:
                continue
            image = Image(height=HEIGHT, width=WIDTH, encoding="mono8", step=WIDTH, data=view(rays, pictures, *at).tobytes())
            image.header.stamp, image.header.frame_id = stamp, "camera"
            bag.write("/camera/image_raw", image, stamp)
            if k % 40 == 0:
                png = io.BytesIO()
                Picture.frombytes("L", (WIDTH, HEIGHT), image.data).save(png, "PNG")
                small = CompressedImage(header=image.header, format="png", data=png.getvalue())
                bag.write("/camera/image_raw/compressed", small, stamp)
            info = CameraInfo(height=HEIGHT, width=WIDTH, distortion_model="plumb_bob", D=[K1, K2, P1, P2, 0])
            info.K = [FX, 0, CX, 0, FY, CY, 0, 0, 1]
            info.header = image.header
            bag.write("/camera/camera_info", info, stamp)


def put_truth(path):
    import h5py

    with h5py.File(path, "r+") as log:
        group = log.create_group("truth/landmarks")
        group["name"] = [f"tag36h11:{i}" for i in range(len(TAGS))]
        for i, name in enumerate(("x_m", "y_m")):
            group[name] = [float(tag[i]) for tag in TAGS]


if sys.argv[1] == "--truth":
    put_truth(sys.argv[2])
else:
    write_bag(*sys.argv[1:])
