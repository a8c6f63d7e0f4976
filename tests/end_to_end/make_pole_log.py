"""A robot that drives thrice round a hall with poles, and what its laser sees: by no code of Cairn's.

  make_pole_log.py CARMEN_LOG      the log, with remissions; the poles are bright. Its odometry is off by 2 % in turns and 1 % of the way
  make_pole_log.py --truth LOG.h5  puts the true poses and poles into what was made of it
"""
import math
import random
import sys

random.seed(5)
WALLS = [(-8, -6, 8, -6), (8, -6, 8, 6), (8, 6, -8, 6), (-8, 6, -8, -6)]
POLES = [(-5.5, -3.8, 0.10), (-2, -3.9, 0.06), (2.2, -3.6, 0.15), (5.8, -4.1, 0.08), (5.9, -0.4, 0.12), (5.7, 3.9, 0.09), (1.4, 3.8, 0.2),
         (-1.8, 4.1, 0.07), (-5.9, 3.7, 0.11), (-6, 0.3, 0.1), (0.2, 0.4, 0.12), (3.1, 0.9, 0.05), (-2.9, -0.8, 0.16)]
BEAMS, REACH, SIGMA, AHEAD = 361, 30, 0.015, 0.2


def ray(x, y, angle):
    c, s = math.cos(angle), math.sin(angle)
    nearest, bright = REACH + 1, 0
    for x0, y0, x1, y1 in WALLS:
        dx, dy = x1 - x0, y1 - y0
        det = s * dx - c * dy
        if abs(det) < 1e-12:
            continue
        t, u = ((y0 - y) * dx - (x0 - x) * dy) / det, (c * (y0 - y) - s * (x0 - x)) / det
        if 0 < t < nearest and 0 <= u <= 1:
            nearest, bright = t, 60 / (1 + t)
    for px, py, radius in POLES:
        along, across = (px - x) * c + (py - y) * s, (py - y) * c - (px - x) * s
        if along > 0 and abs(across) < radius:
            t = along - math.sqrt(radius**2 - across**2)
            if t < nearest:
                nearest, bright = t, 400 / (1 + t)
    return nearest, bright * random.uniform(0.9, 1.1)


def drive():
    """Poses a fifth of a second apart, at 0.5 m/s, on a rounded course that crosses the hall."""
    x, y, heading = -4.0, -2.2, 0.0
    goals = [(4, -2.2), (4.2, 2.2), (-4, 2.2), (-4.2, -2.2)] * 3
    for gx, gy in goals:
        while math.hypot(gx - x, gy - y) > 0.5:
            turn = math.remainder(math.atan2(gy - y, gx - x) - heading, 2 * math.pi)
            heading += max(-0.1, min(0.1, turn))
            x += 0.1 * math.cos(heading)
            y += 0.1 * math.sin(heading)
            yield x, y, heading


def put_truth(path):
    import h5py

    with h5py.File(path, "r+") as log:
        poses = list(drive())
        group = log.create_group("truth/robot/0/poses")
        group["time_s"] = [1000 + 0.2 * k for k in range(len(poses))]
        for i, name in enumerate(("x_m", "y_m", "heading_rad")):
            group[name] = [math.remainder(pose[i], 2 * math.pi) if i == 2 else pose[i] for pose in poses]
        group = log.create_group("truth/landmarks")
        group["name"] = [f"pole {i}" for i in range(len(POLES))]
        for i, name in enumerate(("x_m", "y_m")):
            group[name] = [pole[i] for pole in POLES]


def write_log(path):
    ox = oy = oh = 0.0
    before = None
    with open(path, "w") as out:
        for k, (x, y, heading) in enumerate(drive()):
            if before is not None:
                oh += 1.02 * math.remainder(heading - before[2], 2 * math.pi) + random.gauss(0, 0.002)
                way = 1.01 * math.hypot(x - before[0], y - before[1]) * (1 + random.gauss(0, 0.02))
                ox, oy = ox + way * math.cos(oh), oy + way * math.sin(oh)
            before = x, y, heading
            time = 1000 + 0.2 * k
            lx, ly = x + AHEAD * math.cos(heading), y + AHEAD * math.sin(heading)
            rays = [ray(lx, ly, heading - math.pi / 2 + i * math.pi / 360) for i in range(BEAMS)]
            ranges = " ".join(f"{r + random.gauss(0, SIGMA):.3f}" if r < REACH else f"{REACH}" for r, _ in rays)
            remissions = " ".join(f"{b:.1f}" for _, b in rays)
            laser = f"{ox + AHEAD * math.cos(oh):.5f} {oy + AHEAD * math.sin(oh):.5f} {oh:.6f}"
            out.write(f"ROBOTLASER1 0 {-math.pi / 2:.6f} {math.pi:.6f} {math.pi / 360:.8f} {REACH} 0.01 0 {BEAMS} {ranges} "
                      f"{BEAMS} {remissions} {laser} {ox:.5f} {oy:.5f} {oh:.6f} 0 0 0.4 0.4 1e6 {time:.6f} host {time:.6f}\n")


if sys.argv[1] == "--truth":
    put_truth(sys.argv[2])
else:
    write_log(sys.argv[1])
