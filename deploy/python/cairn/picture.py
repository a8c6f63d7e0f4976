"""What File.plot draws. The only part that needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError

try:
    import matplotlib.pyplot as plt
    from matplotlib.patches import Ellipse
except ImportError as error:
    raise ImportError("plot() needs matplotlib: apt install python3-matplotlib, or pip install matplotlib") from error

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .files import File

_SIGMAS_95 = np.sqrt(-2 * np.log(0.05))  # of two dimensions


def draw(file: File, ax: Axes | None) -> Axes:
    drawn = [_grid, _walls, _landmarks, _paths]
    if not any(part(file, None) for part in drawn):
        raise InputError(f"{file.path}: there is neither a map nor a path in it")
    if ax is None:
        ax = plt.figure().add_subplot()
    for part in drawn:
        part(file, ax)
    ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=_plain(file.path.name))
    if len(ax.get_legend_handles_labels()[0]) > 1:
        ax.legend()
    return ax


def _plain(name: str) -> str:
    """As it is: matplotlib takes $…$ for a formula, and leaves what begins with _ out of legends."""
    return (" " if name.startswith("_") else "") + name.replace("$", r"\$")


# Each draws its part, and says whether there is any.


def _grid(file: File, ax: Axes | None) -> bool:
    if "map/grid/probability" not in file:
        return False
    if ax is not None:
        p = file["map/grid/probability"]
        if p.ndim == 3:  # a layer for each kind of landmark: the probability that any is there
            p = 1 - np.prod(1 - p, axis=0)
        x, y, cell = (file[f"map/grid/{name}"] for name in ("origin_x_m", "origin_y_m", "cell_m"))
        box = (x, x + p.shape[1] * cell, y, y + p.shape[0] * cell)
        ax.imshow(p, cmap="Greys", vmin=0, vmax=1, origin="lower", extent=box, interpolation="nearest")
    return True


def _walls(file: File, ax: Axes | None) -> bool:
    if "truth/walls/x_m" not in file:
        return False
    if ax is not None:
        ax.plot(file["truth/walls/x_m"].T, file["truth/walls/y_m"].T, color="0.7", linewidth=1, zorder=1)
    return True


def _landmarks(file: File, ax: Axes | None) -> bool:
    of = "truth/landmarks/" if "truth/landmarks/x_m" in file else "map/landmark_"
    if f"{of}x_m" not in file:
        return False
    if ax is not None:
        x, y = file[f"{of}x_m"], file[f"{of}y_m"]
        ax.plot(x, y, "+", color="black", zorder=3)
        for at_x, at_y, covariance in zip(x, y, file.get(f"{of}covariance_m2", ())):
            ax.add_patch(_region(at_x, at_y, covariance))
    return True


def _region(x: float, y: float, covariance: Any) -> Ellipse:
    """In which it is by 95%."""
    variances, axes = np.linalg.eigh(covariance)
    width, height = 2 * _SIGMAS_95 * np.sqrt(np.maximum(variances, 0))
    turn = np.degrees(np.arctan2(axes[1, 0], axes[0, 0]))
    return Ellipse((x, y), width, height, angle=turn, fill=False, color="black", linewidth=0.5)


def _paths(file: File, ax: Axes | None) -> bool:
    any_path = False
    for n, robot in enumerate(file.robots):
        for read_path, style in ((file.poses, "-"), (file.odometry, ":")):
            try:
                path = read_path(n)
            except KeyError:
                continue
            any_path = True
            if ax is not None:
                label = robot if style == "-" else f"{robot}, odometry alone"
                ax.plot(path.x_m, path.y_m, style, color=f"C{n % 10}", linewidth=1, label=_plain(label))
    return any_path
