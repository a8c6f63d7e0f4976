"""The peer of studies: plain least squares over poses, landmarks and what odometry errs by, given which observation is of
which landmark and how far everything errs. numpy and scipy alone, nothing of Cairn's.

A control is a turn, then a way forward. True turns are what odometry says less bias * forward, true ways scale * forward.
"""
import dataclasses

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import splu

FLOOR_M, FLOOR_RAD = 1e-3, 1e-4  # of a motion's errors: a straight way alone would leave no error across it


def wrap(a):
    return np.arctan2(np.sin(a), np.cos(a))


def laid_over(a, b):
    """a [n,2] after the rigid motion that lays it best over b, and that motion's turn [2,2]."""
    a0, b0 = a - a.mean(0), b - b.mean(0)
    u, _, vt = np.linalg.svd(a0.T @ b0)
    turn = u @ np.diag([1, np.sign(np.linalg.det(u @ vt))]) @ vt
    return a0 @ turn + b.mean(0), turn


@dataclasses.dataclass
class Widths:
    """Standard deviations of all errors but bias, which is free; a scale without a width is not estimated."""
    walk_rad_per_sqrt_m: float
    turn_ratio: float  # of each turn
    way_m_per_sqrt_m: float  # of each way
    way_ratio: float
    contact_m: float = np.nan
    range_m: float = np.nan
    bearing_rad: float = np.nan
    scale: float = np.inf


@dataclasses.dataclass
class Track:
    """One robot's controls [C,2] (turn, forward), and the numbers of controls before each of its poses [N]."""
    controls: np.ndarray
    steps: np.ndarray


def motion(controls, bias, scale, widths):
    """Of some controls: the motion (x, y, heading), its covariance [3,3], its derivative [3,2] by bias and scale."""
    turn, forward = controls.T
    heading = np.cumsum(turn - bias * forward)
    along = np.column_stack([np.cos(heading), np.sin(heading), np.zeros(len(turn))])
    way = scale * forward[:, None] * along[:, :2]
    at = np.cumsum(way, axis=0)
    rest = at[-1] - (at - way)  # from where each turn was made to the end
    lever = np.column_stack([-rest[:, 1], rest[:, 0], np.ones(len(turn))])
    turned = widths.walk_rad_per_sqrt_m**2 * np.abs(forward) + (widths.turn_ratio * turn) ** 2
    gone = widths.way_m_per_sqrt_m**2 * np.abs(forward) + (widths.way_ratio * forward) ** 2
    covariance = (lever.T * turned) @ lever + (along.T * gone) @ along + np.diag([FLOOR_M, FLOOR_M, FLOOR_RAD]) ** 2
    return np.r_[at[-1], heading[-1]], covariance, np.column_stack([-(forward @ lever), forward @ along])


def reckoned(track, bias=0.0, scale=1.0):
    """The poses [N,3] by odometry alone, from the origin."""
    turn, forward = track.controls.T
    heading = np.cumsum(turn - bias * forward)
    way = scale * forward[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    path = np.vstack([np.zeros(3), np.column_stack([np.cumsum(way, axis=0), heading])])
    return path[track.steps]


class Problem:
    """seen [O,5]: robot, pose, landmark, range, bearing (NaN: a contact, at the robot itself)."""

    def __init__(self, tracks, seen, widths):
        self.tracks, self.seen, self.widths = tracks, seen, widths
        sizes = [len(t.steps) for t in tracks]
        self.first_pose = 3 * np.r_[0, np.cumsum(sizes)]
        self.first_landmark = self.first_pose[-1]
        self.landmarks = int(seen[:, 2].max()) + 1
        self.first_error = self.first_landmark + 2 * self.landmarks
        self.size = self.first_error + 2 * len(tracks)

    def pack(self, poses, landmarks, errors):
        return np.concatenate([*(p.ravel() for p in poses), landmarks.ravel(), np.asarray(errors, float).ravel()])

    def unpack(self, v):
        """The poses of each robot [N,3], landmarks [M,2], bias and scale of each robot [R,2]."""
        poses = [v[a:b].reshape(-1, 3) for a, b in zip(self.first_pose[:-1], self.first_pose[1:])]
        return poses, v[self.first_landmark : self.first_error].reshape(-1, 2), v[self.first_error :].reshape(-1, 2)

    def placed(self, poses):
        """Where the observations put the landmarks on the mean [M,2], seen from these poses."""
        sums, count = np.zeros((self.landmarks, 2)), np.zeros(self.landmarks)
        for robot, pose, landmark, range_m, bearing in self.seen:
            x, y, heading = poses[int(robot)][int(pose)]
            r = np.nan_to_num(range_m)
            sums[int(landmark)] += x + r * np.cos(heading + np.nan_to_num(bearing)), y + r * np.sin(heading + np.nan_to_num(bearing))
            count[int(landmark)] += 1
        return sums / np.maximum(count, 1)[:, None]

    def linearised(self, v):
        """Residuals in standard deviations, and their derivatives."""
        poses, landmarks, errors = self.unpack(v)
        residuals, rows, columns, values, row = [], [], [], [], 0

        def add(error, *derivatives):  # each (first unknown, [rows of the error, unknowns])
            nonlocal row
            residuals.append(error)
            for first, d in derivatives:
                r, c = np.indices(d.shape)
                rows.append((row + r).ravel())
                columns.append((first + c).ravel())
                values.append(d.ravel())
            row += len(error)

        first = poses[0][0] - self.origin
        add(first * 1e4, (0, 1e4 * np.eye(3)))
        for r, track in enumerate(self.tracks):
            bias, scale = errors[r]
            at = self.first_error + 2 * r
            if np.isfinite(self.widths.scale):
                sd = max(self.widths.scale, 1e-9)
                add(np.array([(scale - 1) / sd]), (at, np.array([[0, 1 / sd]])))
            for k in range(len(track.steps) - 1):
                moved, covariance, by = motion(track.controls[track.steps[k] : track.steps[k + 1]], bias, scale, self.widths)
                a, b = poses[r][k], poses[r][k + 1]
                c, s = np.cos(a[2]), np.sin(a[2])
                back = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
                error = back @ (b - a) - moved
                error[2] = wrap(error[2])
                by_a = -back
                by_a[:2, 2] = [(back @ (b - a))[1], -(back @ (b - a))[0]]
                whiten = np.linalg.inv(np.linalg.cholesky(covariance))
                to = self.first_pose[r] + 3 * k
                add(whiten @ error, (to, whiten @ by_a), (to + 3, whiten @ back), (at, -whiten @ by))
        for robot, pose, landmark, range_m, bearing in self.seen:
            x, y, heading = poses[int(robot)][int(pose)]
            to, of = self.first_pose[int(robot)] + 3 * int(pose), self.first_landmark + 2 * int(landmark)
            way = landmarks[int(landmark)] - [x, y]
            if np.isnan(range_m):
                d = np.eye(2) / self.widths.contact_m
                add(way / self.widths.contact_m, (to, -d), (of, d))
                continue
            r = np.hypot(*way)
            off = np.array([r - range_m, wrap(np.arctan2(way[1], way[0]) - heading - bearing)])
            d = np.array([way / r, [-way[1] / r**2, way[0] / r**2]])
            by_pose = np.column_stack([-d, [0, -1]])
            sd = np.array([self.widths.range_m, self.widths.bearing_rad])
            add(off / sd, (to, by_pose / sd[:, None]), (of, d / sd[:, None]))
        jacobian = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (row, self.size))
        return np.concatenate(residuals), jacobian.tocsc()

    def solve(self, poses, errors, most_steps=100):
        """The least from that start, by Levenberg's and Marquardt's steps: (half the sum of squares, poses, landmarks, errors)."""
        self.origin = poses[0][0].copy()
        v = self.pack(poses, self.placed(poses), errors)
        residuals, jacobian = self.linearised(v)
        cost, damping = 0.5 * residuals @ residuals, 1e-6
        for _ in range(most_steps):
            normal, gradient = (jacobian.T @ jacobian).tocsc(), jacobian.T @ residuals
            # Unknowns of which nothing tells (a landmark never seen, a bias beside a scale that is fixed) stay where they are.
            step = -splu(normal + diags(damping * normal.diagonal() + 1e-9)).solve(gradient)
            tried, (new, slopes) = v + step, self.linearised(v + step)
            if 0.5 * new @ new < cost:
                gained = cost - 0.5 * new @ new
                v, residuals, jacobian, cost, damping = tried, new, slopes, cost - gained, max(1e-12, damping / 9)
                if gained < 1e-6:
                    break
            elif np.abs(step).max() < 1e-9 or damping > 1e6:
                break
            else:
                damping *= 4
        return cost, *self.unpack(v)
