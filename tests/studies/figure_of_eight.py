#!/usr/bin/env python3
"""Own logs as a person has them, and what a plain least squares makes of them.

A robot drives a figure of eight (200 m) among six landmarks at random places and sees each that is near and ahead of it:
about 220 observations of range and bearing. Its odometry turns by a constant rate too much and is a few percent too long or
too short; nobody states its errors. `figure_of_eight.py LOG_FOLDER --seed 1 --drift 0.8 --scale 1.03` writes what `cairn import
csv` reads (odometry, observations with names and without, the truth), and prints how far off the path of the best of several
least squares over all poses, landmarks, bias and scale is, in metres (RMSE at the poses at which something was seen, after the
rigid motion that fits best). With `--result DIR`, of what `cairn run landmark_map` made of the log, it prints the same of that.
"""
import argparse
import csv
import pathlib

import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import lil_matrix

RATE_HZ, SPEED_MPS, LENGTH_M, LANDMARKS, SIGHTINGS = 10.0, 1.0, 200.0, 6, 220
RANGE_SD_M, BEARING_SD_RAD = 0.10, np.radians(1.0)
FORWARD_SD, WALK_SD = 0.02, np.radians(0.5)  # per root metre


def wrap(a):
    return np.arctan2(np.sin(a), np.cos(a))


def drive(seed, drift_deg_per_m, scale):
    """The true path [n+1,3], what odometry says of it [n,2] (turn, forward), landmarks [6,2], sightings [k,4]
    (step, landmark, range, bearing)."""
    rng = np.random.default_rng([seed, 8])
    n = int(LENGTH_M / SPEED_MPS * RATE_HZ)
    t = np.linspace(0, 4 * np.pi, 4001)  # twice round
    curve = np.stack([np.sin(t), np.sin(t) * np.cos(t)], 1)
    lengths = np.r_[0, np.cumsum(np.hypot(*np.diff(curve, axis=0).T))]
    curve *= LENGTH_M / lengths[-1]
    at = np.linspace(0, LENGTH_M, n + 1)
    xy = np.stack([np.interp(at, lengths * LENGTH_M / lengths[-1], curve[:, k]) for k in range(2)], 1)
    step = np.diff(xy, axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    forward = np.hypot(*step.T)
    turn = np.r_[0.0, np.diff(heading)]
    # The frame is the robot's first pose.
    c, s = np.cos(heading[0]), np.sin(heading[0])
    turned = (xy - xy[0]) @ np.array([[c, -s], [s, c]])
    path = np.column_stack([turned, np.r_[0.0, heading - heading[0]]])
    said_forward = forward * scale + rng.normal(0, FORWARD_SD, n) * np.sqrt(forward)
    said_turn = turn + np.radians(drift_deg_per_m) * forward + rng.normal(0, WALK_SD, n) * np.sqrt(forward)
    half = np.abs(turned).max(0) + 2
    while True:
        landmarks = rng.uniform(-1, 1, (LANDMARKS, 2)) * half + turned.mean(0)
        gaps = np.hypot(*(landmarks[:, None] - landmarks[None]).transpose(2, 0, 1)) + 99 * np.eye(LANDMARKS)
        if gaps.min() > 3:
            break
    seen = []
    for k in range(5, n + 1, 5):
        for l in range(LANDMARKS):
            d = landmarks[l] - path[k, :2]
            r, b = np.hypot(*d), wrap(np.arctan2(d[1], d[0]) - path[k, 2])
            if r < 12 and abs(b) < np.radians(90):
                seen.append((k, l, r, b))
    keep = np.sort(rng.choice(len(seen), min(SIGHTINGS, len(seen)), replace=False))
    seen = np.array([seen[i] for i in keep])
    seen[:, 2] += rng.normal(0, RANGE_SD_M, len(seen))
    seen[:, 3] = wrap(seen[:, 3] + rng.normal(0, BEARING_SD_RAD, len(seen)))
    return path, np.column_stack([said_turn, said_forward]), landmarks, seen


def write(folder, path, odometry, landmarks, seen):
    folder.mkdir(parents=True, exist_ok=True)

    def table(name, header, rows):
        with open(folder / name, "w", newline="") as f:
            out = csv.writer(f)
            out.writerow(header)
            out.writerows(rows)

    time = lambda k: f"{k / RATE_HZ:.2f}"
    # The order of the rows within a time is that of the names.
    table("odometry.csv", ["time_s", "turn_rad", "forward_m"],
          [[time(k + 1), f"{u[0]:.7f}", f"{u[1]:.6f}"] for k, u in enumerate(odometry)])
    for name, known in (("named.csv", True), ("nameless.csv", False)):
        table(name, ["time_s", "landmark", "range_m", "bearing_rad"],
              [[time(k), f"L{int(l)}" if known else "", f"{r:.4f}", f"{b:.5f}"] for k, l, r, b in seen])
    table("truth_poses.csv", ["time_s", "x_m", "y_m", "heading_rad"],
          [[time(k), f"{p[0]:.5f}", f"{p[1]:.5f}", f"{wrap(p[2]):.6f}"] for k, p in enumerate(path) if k])
    table("truth_landmarks.csv", ["landmark", "x_m", "y_m"], [[f"L{l}", *p] for l, p in enumerate(landmarks)])
    table("truth_associations.csv", ["time_s", "landmark"], [[time(k), f"L{int(l)}"] for k, l, _, _ in seen])


def reckon(odometry, bias, scale):
    turn = odometry[:, 0] - bias * odometry[:, 1] / scale
    heading = np.cumsum(turn)
    xy = np.cumsum(odometry[:, 1:] / scale * np.column_stack([np.cos(heading), np.sin(heading)]), axis=0)
    return np.vstack([np.zeros(3), np.column_stack([xy, heading])])


def solve(odometry, seen, bias0):
    """Least squares over poses where something was seen, landmarks, bias and scale."""
    steps = np.unique(np.r_[0, seen[:, 0].astype(int), len(odometry)])
    index = {k: i for i, k in enumerate(steps)}
    m = len(steps)

    def increments(bias, scale):  # of each leg, in the frame of its first pose, and d/dbias, d/dscale numerically
        out = []
        for a, b in zip(steps[:-1], steps[1:]):
            p = reckon(odometry[a:b], bias, scale)[-1]
            out.append(p)
        return np.array(out)

    first = reckon(odometry, bias0, 1.0)[steps]
    placed = np.zeros((LANDMARKS, 2))
    count = np.zeros(LANDMARKS)
    for k, l, r, b in seen:
        p = first[index[int(k)]]
        placed[int(l)] += p[:2] + r * np.array([np.cos(p[2] + b), np.sin(p[2] + b)])
        count[int(l)] += 1
    placed /= np.maximum(count, 1)[:, None]
    length = np.array([odometry[a:b, 1].sum() for a, b in zip(steps[:-1], steps[1:])])
    pose_of = np.array([index[int(k)] for k in seen[:, 0]])
    of = seen[:, 1].astype(int)
    sd_turn, sd_way = WALK_SD * np.sqrt(length), FORWARD_SD * np.sqrt(length)
    sd_across = 0.6 * length * sd_turn + 1e-3

    def residuals(v):
        pose = np.vstack([np.zeros(3), v[: 3 * (m - 1)].reshape(-1, 3)])
        marks = v[3 * (m - 1) : -2].reshape(-1, 2)
        inc = increments(v[-2], v[-1])
        d = pose[1:, :2] - pose[:-1, :2]
        c, s = np.cos(pose[:-1, 2]), np.sin(pose[:-1, 2])
        ex, ey = c * d[:, 0] + s * d[:, 1] - inc[:, 0], -s * d[:, 0] + c * d[:, 1] - inc[:, 1]
        eh = pose[1:, 2] - pose[:-1, 2] - inc[:, 2]
        # The walk of the heading goes into the end across: half of it.
        way = marks[of] - pose[pose_of, :2]
        er = np.hypot(*way.T) - seen[:, 2]
        eb = wrap(np.arctan2(way[:, 1], way[:, 0]) - pose[pose_of, 2] - seen[:, 3])
        across = (ey - 0.5 * length * eh) / (length * sd_turn / np.sqrt(12) + 1e-3)
        return np.concatenate([ex / sd_way, across, eh / sd_turn, er / RANGE_SD_M, eb / BEARING_SD_RAD])

    size = 3 * (m - 1) + 2 * LANDMARKS + 2
    pattern = lil_matrix((3 * (m - 1) + 2 * len(seen), size), dtype=int)
    for e in range(m - 1):
        for row in (e, m - 1 + e, 2 * (m - 1) + e):
            for pose in (e, e + 1):
                if pose > 0:
                    pattern[row, 3 * (pose - 1) : 3 * pose] = 1
            pattern[row, -2:] = 1
    for i in range(len(seen)):
        for row in (3 * (m - 1) + i, 3 * (m - 1) + len(seen) + i):
            if pose_of[i] > 0:
                pattern[row, 3 * (pose_of[i] - 1) : 3 * pose_of[i]] = 1
            at = 3 * (m - 1) + 2 * of[i]
            pattern[row, at : at + 2] = 1
    start = np.concatenate([first[1:].ravel(), placed.ravel(), [bias0, 1.0]])
    fit = least_squares(residuals, start, jac_sparsity=pattern, method="trf", x_scale="jac", max_nfev=100)
    pose = np.vstack([np.zeros(3), fit.x[: 3 * (m - 1)].reshape(-1, 3)])
    return fit.cost, steps, pose, fit.x[3 * (m - 1) : -2].reshape(-1, 2), fit.x[-2:]


def rigid_rmse(a, b):
    a0, b0 = a - a.mean(0), b - b.mean(0)
    u, _, vt = np.linalg.svd(a0.T @ b0)
    turn = u @ np.diag([1, np.sign(np.linalg.det(u @ vt))]) @ vt
    return np.sqrt(((a0 @ turn - b0) ** 2).sum(1).mean())


def best(odometry, seen):
    return min((solve(odometry, seen, np.radians(b)) for b in (-1.5, -0.75, 0, 0.75, 1.5)), key=lambda fit: fit[0])


def path_error(folder, path, seen):
    """Of a result's path, at the poses at which something was seen."""
    import h5py

    with h5py.File(folder / "landmark_map.h5") as result:
        poses = {name: result[f"robot/0/poses/{name}"][:] for name in ("time_s", "x_m", "y_m")}
    steps = np.unique(seen[:, 0].astype(int))
    at = [np.interp(steps / RATE_HZ, poses["time_s"], poses[name]) for name in ("x_m", "y_m")]
    return rigid_rmse(np.stack(at, 1), path[steps, :2])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--drift", type=float, default=0.3, help="degrees a metre")
    parser.add_argument("--scale", type=float, default=1.03)
    parser.add_argument("--no-fit", action="store_true", help="write the log only")
    parser.add_argument("--result", type=pathlib.Path, help="a result of the log, whose path's error to print instead")
    a = parser.parse_args()
    path, odometry, landmarks, seen = drive(a.seed, a.drift, a.scale)
    if a.result:
        print(f"path {path_error(a.result, path, seen):.4f} m")
        return
    write(a.folder, path, odometry, landmarks, seen)
    if a.no_fit:
        return
    cost, steps, pose, marks, (bias, scale) = best(odometry, seen)
    print(f"least squares: path {rigid_rmse(pose[:, :2], path[steps, :2]):.4f} m, drift {np.degrees(bias):.3f} deg/m, "
          f"scale {scale:.4f}, {len(seen)} sightings, cost {cost:.1f}")


main()
