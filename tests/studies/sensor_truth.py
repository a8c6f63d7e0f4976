#!/usr/bin/env python3
"""What ranges, bearings and true headings err by, held against true poses and landmarks.

  cairn import mrclam "$CAIRN_DATA/mrclam6" mrclam6.h5
  tests/studies/sensor_truth.py mrclam6.h5 --late-s 0.2

Of each robot: what ranges err by, as a share of the distance, by the bearing; how wide they err, before and after a + b R +
c R bearing^2 is taken off (c of -0.5: what is said is the depth, not the range); how far true headings are from the course of
the true positions, and from what the bearings say, both in stretches of 5 s, and how these two go together: where they do, it
is the true headings that err.

Needs python3-numpy, python3-h5py.
"""
import argparse

import h5py
import numpy as np

STRETCH_S, CHORD_S, BINS_DEG = 5, 2, range(-32, 32, 8)


def wrap(a):
    return np.arctan2(np.sin(a), np.cos(a))


class Truth:
    def __init__(self, poses):
        self.time = poses["time_s"][:]
        self.columns = [poses["x_m"][:], poses["y_m"][:], np.unwrap(poses["heading_rad"][:])]

    def at(self, time):
        return [np.interp(time, self.time, column) for column in self.columns]


def course_less_heading(truth):
    """Where it drives straight ahead: times, and by how much the course is more than the heading."""
    time = np.arange(truth.time[0] + CHORD_S, truth.time[-1] - CHORD_S, 0.5)
    (xa, ya, ha), (xb, yb, hb), at = truth.at(time - CHORD_S / 2), truth.at(time + CHORD_S / 2), truth.at(time)
    course = wrap(np.arctan2(yb - ya, xb - xa) - at[2])
    straight = (np.hypot(xb - xa, yb - ya) > 0.05 * CHORD_S) & (abs(hb - ha) < 0.03 * CHORD_S) & (abs(course) < 0.5)
    return time[straight], course[straight]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log")
    parser.add_argument("--late-s", type=float, default=0.0, help="by so much the observations' times are too late")
    args = parser.parse_args()
    with h5py.File(args.log) as log:
        landmarks = np.column_stack([log["truth/landmarks/x_m"][:], log["truth/landmarks/y_m"][:]])
        for r, name in enumerate(log["robots"][:]):
            seen, truth = log[f"robot/{r}/observations"], Truth(log[f"truth/robot/{r}/poses"])
            time, of = seen["time_s"][:] - args.late_s, seen["landmark"][:]
            x, y, heading = truth.at(time)
            way = landmarks[of] - np.column_stack([x, y])
            distance, bearing = np.hypot(*way.T), seen["bearing_rad"][:]
            ranged = seen["range_m"][:] - distance
            turned = wrap(bearing - np.arctan2(way[:, 1], way[:, 0]) + heading)
            known = (of >= 0) & (time > truth.time[0]) & (time < truth.time[-1]) & (abs(ranged) < 1) & (abs(turned) < 0.3)
            time, distance, bearing, ranged, turned = (a[known] for a in (time, distance, bearing, ranged, turned))
            degrees = np.degrees(bearing)
            bins = [(low, (degrees >= low) & (degrees < low + 8)) for low in BINS_DEG]
            shares = ", ".join(f"{low}: {100 * np.median(ranged[b] / distance[b]):+.1f}" for low, b in bins if b.sum() > 8)
            terms = np.column_stack([np.ones(len(distance)), distance, distance * bearing**2])
            fit = np.linalg.lstsq(terms, ranged, rcond=None)[0]
            print(f"robot {name.decode()}: {len(time)} observations; ranges off by [%], by the bearing from [deg]: {shares}")
            print(f"  ranges err by {ranged.std():.3f} m; less {fit[0]:+.3f} m {fit[1]:+.3f} R {fit[2]:+.2f} R bearing^2 by {(ranged - terms @ fit).std():.3f} m")
            when, course = course_less_heading(truth)
            pairs = []
            for begin in np.arange(truth.time[0], truth.time[-1], STRETCH_S):
                a, b = (when >= begin) & (when < begin + STRETCH_S), (time >= begin) & (time < begin + STRETCH_S)
                if a.sum() >= 4 and b.sum() >= 4:
                    pairs.append([np.median(course[a]), -np.median(turned[b])])
            by_course, by_bearings = np.degrees(pairs).T
            print(f"  true headings in {len(pairs)} stretches: off the course by {by_course.std():.2f} deg (up to {abs(by_course - np.median(by_course)).max():.2f}), off the "
                  f"bearings by {by_bearings.std():.2f} deg, correlation {np.corrcoef(by_course, by_bearings)[0, 1]:.2f}, slope {np.polyfit(by_course, by_bearings, 1)[0]:.2f}")


main()
