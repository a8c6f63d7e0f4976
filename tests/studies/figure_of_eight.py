#!/usr/bin/env python3
"""A first own log, mapped by Cairn and by a plain least squares (scipy's).

A robot drives a figure of eight (200 m) among six landmarks at random places and sees each that is near and ahead of it:
about 220 observations of range and bearing. Its odometry turns by a constant rate too much and is 3% too short to 5% too
long; nobody tells Cairn so, nor how far anything errs. The peer knows all widths: it is the best of five least squares over all poses at
observations, landmarks, drift and scale, each from another drift. Both paths are compared with the truth at the same times,
those of the observations and the path's end, after the rigid motion that fits best.

  tests/studies/figure_of_eight.py 21 25               seeds 21 to 25, with names
  tests/studies/figure_of_eight.py 21 25 --nameless    landmarks all alike; the peer still knows which is which

Needs python3-numpy, python3-scipy, python3-h5py.
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

from least_squares import Problem, Track, Widths, laid_over, reckoned, wrap

RATE_HZ, SPEED_MPS, LENGTH_M, LANDMARKS, SIGHTINGS = 10.0, 1.0, 200.0, 6, 220
RANGE_SD_M, BEARING_SD_RAD = 0.10, np.radians(1.0)
FORWARD_SD, WALK_SD = 0.02, np.radians(0.5)  # per root metre


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


def solve(odometry, seen, bias0):
    """Least squares over poses where something was seen, landmarks, bias and scale: half the sum of squares, steps, poses there."""
    steps = np.unique(np.r_[0, seen[:, 0].astype(int), len(odometry)])
    track = Track(odometry, steps)
    widths = Widths(WALK_SD, 0.0, FORWARD_SD, 0.0, range_m=RANGE_SD_M, bearing_rad=BEARING_SD_RAD)
    rows = np.column_stack([np.zeros(len(seen)), np.searchsorted(steps, seen[:, 0]), seen[:, 1:]])
    cost, poses, _, _ = Problem([track], rows, widths).solve([reckoned(track, bias0)], [(bias0, 1.0)])
    return cost, steps, poses[0]


def best(odometry, seen):
    return min((solve(odometry, seen, np.radians(b)) for b in (-1.5, -0.75, 0, 0.75, 1.5)), key=lambda fit: fit[0])


DRIFTS_DEG_PER_M = (0.1, 0.3, 0.8, 1.5)


def scale_of(seed, drift):
    return np.random.default_rng([seed, round(10 * drift), 9]).uniform(0.97, 1.05)


def mapped(cairn, folder, kind, arguments):
    """Cairn's path [P,3] (time_s, x_m, y_m) with the covariances of its positions [P,2,2], and the first line of its verdict."""
    log = folder / f"{kind}.h5"
    subprocess.run([cairn, "import", "csv", "--odometry", folder / "odometry.csv", "--observations", folder / f"{kind}.csv", log],
                   check=True, capture_output=True)
    run = subprocess.run([cairn, "run", "landmark_map", log, "--out", folder / kind, *arguments], capture_output=True, text=True)
    said = [line.split(None, 1)[1] for line in run.stdout.splitlines() if line.startswith("verdict")]
    if run.returncode:
        return None, None, run.stderr.strip().splitlines()[-1]
    with h5py.File(folder / kind / "landmark_map.h5") as result:
        poses = result["robot/0/poses"]
        path = np.column_stack([poses["time_s"], poses["x_m"], poses["y_m"]])
        return path, poses["covariance"][:, :2, :2], said[0]


def at_times(times, path):
    return np.column_stack([np.interp(times, path[:, 0], path[:, k]) for k in (1, 2)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("--nameless", action="store_true")
    parser.add_argument("--cairn", type=pathlib.Path, default=pathlib.Path("build/release/bin/cairn"))
    parser.add_argument("--keep", type=pathlib.Path, help="leave the logs and results in this folder")
    parser.add_argument("arguments", nargs="*", help="of `cairn run`, after --")
    a = parser.parse_args()
    bound = 1.25 if a.nameless else 1.10
    ratios, high, squares = [], [], []
    with tempfile.TemporaryDirectory() as scratch:
        for seed in range(a.first, a.last + 1):
            for drift in DRIFTS_DEG_PER_M:
                path, odometry, landmarks, seen = drive(seed, drift, scale_of(seed, drift))
                folder = (a.keep or pathlib.Path(scratch)) / f"{seed}-{drift}"
                write(folder, path, odometry, landmarks, seen)
                _, steps, pose = best(odometry, seen)
                peer = np.sqrt(((laid_over(pose[:, :2], path[steps, :2])[0] - path[steps, :2]) ** 2).sum(1).mean())
                ours, covariance, verdict = mapped(a.cairn, folder, "nameless" if a.nameless else "named", a.arguments)
                if ours is None:
                    ratios.append(np.inf)
                    high.append(False)
                    print(f"{seed} {drift}: no map: {verdict}")
                    continue
                times = np.arange(len(path)) / RATE_HZ
                truth = np.column_stack([times, path[:, :2]])
                at = steps / RATE_HZ
                error = np.sqrt(((laid_over(at_times(at, ours), path[steps, :2])[0] - path[steps, :2]) ** 2).sum(1).mean())
                true = at_times(ours[:, 0], truth)
                laid, turn = laid_over(ours[:, 1:], true)
                off = (laid - true) @ turn.T  # in the map's frame, as the covariances are
                squares.append(np.einsum("ni,nij,nj->n", off, np.linalg.inv(covariance), off))
                ratios.append(error / peer)
                high.append(verdict.startswith("high"))
                print(f"{seed} {drift}: {error:.3f} m, the peer {peer:.3f} m, {error / peer:.2f}; {verdict}", flush=True)
    ratios, high = np.array(ratios), np.array(high)
    right = ratios <= bound
    print(f"within {bound:.2f} of the peer: {right.sum()} of {len(right)}; the median {np.median(ratios):.2f}, the worst {ratios.max():.2f}")
    print(f"'high': {high.sum()}, of which right {(high & right).sum()}; not right, and not 'high': {(~high & ~right).sum()}")
    if squares:
        inside = [100 * np.mean([(s < edge).mean() for s in squares]) for edge in (1.386, 5.991)]
        print(f"of true positions in the 50% regions {inside[0]:.0f}%, in the 95% regions {inside[1]:.0f}%; "
              f"mean square {np.mean([s.mean() for s in squares]):.2f} of 2")


main()
