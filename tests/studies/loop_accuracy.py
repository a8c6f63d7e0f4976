#!/usr/bin/env python3
"""How exact landmark_map is, beside a least squares that is told all, and how right its covariances are.

Simulated loops (`cairn simulate loop`) are mapped and scored by `cairn evaluate`. The peer (least_squares.py) is given which
observation is of which landmark, and all standard deviations, measured on the truth; it starts from the truth. What odometry
errs by all along (drift, and scale where ranges tell it) it estimates. Where Cairn's topology is right both maps are laid over
the true landmarks by the rigid motion that fits best, and both paths over the true one. The interval of NEES is that of
landmarks that err together as the result's joint covariance says.

  tests/studies/loop_accuracy.py 101 120 base hard             kinds of loops: see KINDS
  CAIRN_DATA=… tests/studies/loop_accuracy.py --recorded       covariances alone, of four recorded logs

Needs python3-numpy, python3-scipy, python3-h5py.
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np
from scipy.optimize import minimize

from least_squares import Problem, Track, Widths, laid_over, wrap

CAMERA = ["--sensor", "range-bearing"]
KINDS = {
    **{name: ["--difficulty", name] for name in ("paper", "base", "hard", "extreme", "museum")},
    "base-robots": ["--robots", "2"],
    "camera": CAMERA,
    "camera-names": [*CAMERA, "--identities"],
    "camera-robots": [*CAMERA, "--robots", "2"],
}
RECORDED = {
    **{f"mrclam{n}": ["mrclam", f"mrclam{n}", "--skip-bad"] for n in (1, 6, 9)},
    "lego": ["lego-robot", "lego-robot"],
}


WORDS = {True: "right", False: "wrong", None: "not known"}


def table(group, *names):
    return np.column_stack([group[name][:] for name in names])


def root_mean_square(errors):
    return np.sqrt((errors**2).sum(-1).mean())


class Log:
    """What a simulated log says, and the truth of it."""

    def __init__(self, path):
        with h5py.File(path) as log:
            self.landmarks = table(log["truth/landmarks"], "x_m", "y_m")
            self.tracks, self.true_poses, self.times, self.of, seen, controls = [], [], [], [], [], []
            for r in range(len(log["robots"])):
                robot, truth = log[f"robot/{r}"], log[f"truth/robot/{r}"]
                odometry = table(robot["odometry"], "turn_rad", "forward_m")
                ends, poses = robot["odometry/time_s"][:], table(truth["poses"], "x_m", "y_m", "heading_rad")
                observations = table(robot["observations"], "time_s", "range_m", "bearing_rad")
                of = truth["observations/landmark"][:]
                real = of >= 0
                at = np.searchsorted(ends, observations[:, 0] + 1e-6)  # so many controls have ended by then
                steps = np.unique(np.r_[0, at])
                self.tracks.append(Track(odometry, steps))
                self.true_poses.append(poses[steps])
                self.times.append(truth["poses/time_s"][:][steps])
                self.of.append(of)
                pose = np.searchsorted(steps, at)
                seen.append(np.column_stack([np.full(len(of), r), pose, of, observations[:, 1:]])[real])
                true_turn, true_way = wrap(np.diff(poses[:, 2])), np.hypot(*np.diff(poses[:, :2], axis=0).T)
                controls.append((odometry, np.column_stack([true_turn, true_way])))
        self.seen = np.concatenate(seen)
        self.widths = self.measured(controls)

    def measured(self, controls):
        """Of the errors' standard deviations those that are likeliest, with all errors at hand."""

        def unlikely(v):  # walk, turn ratio; a bias of each robot
            variances = [np.exp(2 * v[0]) * true[:, 1] + np.exp(2 * v[1]) * true[:, 0] ** 2 + 1e-12 for _, true in controls]
            errors = [wrap(said[:, 0] - true[:, 0]) - b * true[:, 1] for b, (said, true) in zip(v[2:], controls)]
            return sum(0.5 * (np.log(s) + e**2 / s).sum() for e, s in zip(errors, variances))

        fit = minimize(unlikely, [np.log(0.01), np.log(0.02), *np.zeros(len(controls))], method="Nelder-Mead",
                       options={"maxiter": 4000, "maxfev": 4000, "xatol": 1e-5, "fatol": 1e-3})
        ratios = [said[true[:, 1] > 1e-3, 1] / true[true[:, 1] > 1e-3, 1] for said, true in controls]
        poses = np.array([self.true_poses[int(r)][int(k)] for r, k in self.seen[:, :2]])
        way = self.landmarks[self.seen[:, 2].astype(int)] - poses[:, :2]
        widths = Widths(*np.exp(fit.x[:2]), 0.0, np.sqrt(np.mean([np.var(r) for r in ratios])))
        if np.isnan(self.seen[0, 3]):
            widths.contact_m, widths.scale = np.sqrt((way**2).mean()), 0.0
        else:
            widths.range_m = np.std(np.hypot(*way.T) - self.seen[:, 3])
            widths.bearing_rad = np.std(wrap(np.arctan2(way[:, 1], way[:, 0]) - poses[:, 2] - self.seen[:, 4]))
        return widths

    def peer(self):
        """Its landmarks [M,2] and poses of each robot [N,3]."""
        problem = Problem(self.tracks, self.seen, self.widths)
        unwrapped = [np.column_stack([p[:, :2], np.unwrap(p[:, 2])]) for p in self.true_poses]
        _, *solution = problem.solve(unwrapped, [(0.0, 1.0)] * len(self.tracks))
        if self.widths.scale == 0.0:  # not estimated of contact detections, but uncertain all the same
            problem.widths.scale = 0.02
        return solution[1], solution[0]

    def errors(self, landmarks, paths):
        """RMSE of landmarks {true one: place}, and of paths [N,2] at the poses' times."""
        true = self.landmarks[list(landmarks)]
        path, true_path = np.concatenate(paths), np.concatenate([p[:, :2] for p in self.true_poses])
        return [root_mean_square(laid_over(a, b)[0] - b) for a, b in ((np.array(list(landmarks.values())), true), (path, true_path))]


def compared(log, result):
    """RMSE of Cairn's landmarks and path, and the peer's of the same."""
    with h5py.File(result) as found:
        places = table(found["map"], "landmark_x_m", "landmark_y_m")
        votes, ours = np.zeros((len(log.landmarks), len(places))), []
        for r, of in enumerate(log.of):
            robot = found[f"robot/{r}"]
            mine = robot["observations/map_landmark"][:]
            np.add.at(votes, (of[(of >= 0) & (mine >= 0)], mine[(of >= 0) & (mine >= 0)]), 1)
            poses = table(robot["poses"], "time_s", "mode_x_m", "mode_y_m")
            ours.append(np.column_stack([np.interp(log.times[r], poses[:, 0], poses[:, k]) for k in (1, 2)]))
    known = {int(l): places[votes[l].argmax()] for l in np.flatnonzero(votes.any(1))}
    landmarks, poses = log.peer()
    theirs = log.errors({l: landmarks[l] for l in known}, [p[:, :2] for p in poses])
    return log.errors(known, ours), theirs


def run(cairn, *words):
    done = subprocess.run([cairn, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"cairn {' '.join(map(str, words))}: {done.stderr.strip().splitlines()[-1]}")
    return done.stdout


def mapped(cairn, log, out, arguments):
    """The scores of `cairn evaluate`, and the first word of the verdict."""
    said = run(cairn, "run", "landmark_map", log, "--out", out, "--force", *arguments)
    verdict = [line.split()[1].rstrip(":") for line in said.splitlines() if line.startswith("verdict")]
    return json.loads(run(cairn, "evaluate", out, "--truth", log, "--json")), verdict[0]


class Coverage:
    """Of landmarks, or of poses: shares of the errors within their regions, over all logs."""

    def __init__(self):
        self.counts, self.nees, self.calibrated = [], [], 0

    def add(self, score):
        self.counts.append([score["count"], score["within_50"] * score["count"], score["within_95"] * score["count"]])
        self.nees.append(score["nees"])
        self.calibrated += score["nees_99"] is not None and score["nees_99"][0] <= score["nees"] <= score["nees_99"][1]

    def text(self):
        if not self.counts:
            return " | "  # truth has none
        count, *within = np.sum(self.counts, axis=0)
        return (f"{100 * within[0] / count:.0f}, {100 * within[1] / count:.1f}% | "
                f"{np.mean(self.nees):.2f}; {self.calibrated} of {len(self.nees)}")


class Kind:
    HEADER = ("| logs | topology right; 'high' | landmarks, the peer: median; all; within 1.05 | paths, the same "
              "| landmarks in 50, 95% regions | NEES; in its interval | poses in 50, 95% regions | NEES; in its interval |\n"
              "| --- | --- | --- | --- | --- | --- | --- | --- |")

    def __init__(self, name):
        self.name, self.known, self.right, self.high, self.pairs = name, 0, 0, 0, []
        self.coverage = {"landmarks": Coverage(), "poses": Coverage()}

    def add(self, seed, score, verdict, pair):
        right = score["topology"]["correct"]
        self.known += right is not None
        self.right += right is True
        self.high += verdict == "high"
        text = f"{self.name} {seed}: topology {WORDS[right]}, verdict {verdict}"
        if pair:
            self.pairs.append(pair)
            (ours, path), (theirs, their_path) = pair
            text += (f"; landmarks {ours:.3f} m, the peer {theirs:.3f} m, {ours / theirs:.2f};"
                     f" path {path:.3f} m, {their_path:.3f} m, {path / their_path:.2f}")
        for what, coverage in self.coverage.items():
            of = score["calibration"][what]
            if of:
                coverage.add(of)
                text += f"; {what} {100 * of['within_95']:.0f}% in 95%, NEES {of['nees']:.2f}"
        print(text, flush=True)

    def row(self):
        cells = [self.name, f"{self.right} of {self.known}; {self.high}"]
        for k in (0, 1):  # landmarks, paths
            ours, theirs = np.array([[pair[i][k] for pair in self.pairs] for i in (0, 1)]).reshape(2, -1)
            if not len(ours):
                cells.append("")
                continue
            together = np.sqrt((ours**2).mean() / (theirs**2).mean())
            cells.append(f"{np.median(ours):.2f}, {np.median(theirs):.2f} m: {np.median(ours / theirs):.2f}; {together:.2f}; "
                         f"{(ours <= 1.05 * theirs).sum()} of {len(ours)}")
        return f"| {' | '.join([*cells, self.coverage['landmarks'].text(), self.coverage['poses'].text()])} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=int, nargs="?")
    parser.add_argument("last", type=int, nargs="?")
    parser.add_argument("kinds", nargs="*", help=", ".join(KINDS))
    parser.add_argument("--recorded", action="store_true")
    parser.add_argument("--cairn", type=pathlib.Path, default=pathlib.Path("build/release/bin/cairn"))
    parser.add_argument("--set", action="append", default=[], help="key=value, an option of landmark_map")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, help="leave the logs and results in this folder")
    a = parser.parse_args()
    if unknown := set(a.kinds) - set(KINDS):
        parser.error(f"no kind {sorted(unknown)[0]}; there are {', '.join(KINDS)}")
    if bool(a.kinds) == a.recorded:
        parser.error("say FIRST LAST KIND…, or --recorded")
    cairn = a.cairn.resolve()
    arguments, kinds = [f"--workers={a.workers}", *(f"--set={s}" for s in a.set)], []
    with tempfile.TemporaryDirectory() as scratch:
        folder = a.keep or pathlib.Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name, words in RECORDED.items() if a.recorded else ():
            kinds.append(Kind(name))
            log = folder / f"{name}.h5"
            run(cairn, "import", words[0], pathlib.Path(os.environ["CAIRN_DATA"], words[1]), log, "--force", *words[2:])
            kinds[-1].add("", *mapped(cairn, log, folder / name, arguments), None)
        for name in a.kinds:
            kinds.append(Kind(name))
            for seed in range(a.first, a.last + 1):
                log, out = folder / f"{name}-{seed}.h5", folder / f"{name}-{seed}"
                run(cairn, "simulate", "loop", *KINDS[name], "--seed", seed, log, "--force")
                score, verdict = mapped(cairn, log, out, arguments)
                right = score["topology"]["correct"]
                kinds[-1].add(seed, score, verdict, compared(Log(log), out / "landmark_map.h5") if right else None)
    print(Kind.HEADER, *(kind.row() for kind in kinds), sep="\n")


main()
