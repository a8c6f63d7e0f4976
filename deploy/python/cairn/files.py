"""Cairn's files as numpy arrays by name (schema/FORMAT.md)."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np
import numpy.typing as npt

from .checksum import trailer_is_right
from .errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FORMAT = 1  # the newest that is known
_GIVEN = ("log", "poses", "samples", "errors")  # kinds that people make, and may change
_Column = npt.NDArray[np.float64]


class Poses(NamedTuple):
    """A robot's poses, each column [P]: x ahead at heading 0, headings counter-clockwise."""

    time_s: _Column
    x_m: _Column
    y_m: _Column
    heading_rad: _Column


class File(Mapping[str, Any]):
    """An open file of Cairn's: its arrays by name, `file["map/landmark_x_m"]`.

    An array is read when it is first asked for, and kept. It cannot be written to: `.copy()` can. A number or a text that is
    none of many comes as such. `with cairn.read(…) as file:` closes the file at the end; what was read stays.
    """

    path: Path
    kind: str  #: "log", "landmark_map", …
    changed: bool  #: another program has changed it since Cairn wrote it

    def __init__(self, path: Path, file: h5py.File, kind: str, changed: bool) -> None:
        self.path, self.kind, self.changed = path, kind, changed
        self._file = file
        self._names: dict[str, None] = {}
        self._read: dict[str, Any] = {}
        file.visititems(self._add)  # follows no links to elsewhere

    def _add(self, name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset):
            return
        if item.external or item.is_virtual:
            raise InputError(f"{self.path}: the data of '{name}' lie in another file")
        self._names[name] = None

    def _dataset(self, name: str) -> h5py.Dataset:
        if name not in self._names:
            near = difflib.get_close_matches(name, self._names, 3)
            meant = f"; is it {' or '.join(repr(n) for n in near)}?" if near else ""
            raise KeyError(f"there is no '{name}' in {self.path}{meant}")
        if not self._file:
            raise InputError(f"{self.path}: it was closed before '{name}' was read")
        return self._file[name]

    def __getitem__(self, name: str) -> Any:
        if name not in self._read:
            dataset = self._dataset(name)
            try:
                value = dataset[()]
            except OSError as error:
                raise InputError(f"{self.path}: damaged: '{name}' cannot be read: {error}") from None
            self._read[name] = _plain(value, bool(dataset.attrs.get("scalar", 0)))
        return self._read[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def shape(self, name: str) -> tuple[int, ...]:
        """Of an array, without reading it; () of one that is a number or a text alone."""
        dataset = self._dataset(name)
        return () if dataset.attrs.get("scalar", 0) else tuple(dataset.shape)

    def unit(self, name: str) -> str:
        """"m", "rad/m", …; "1" of what has none."""
        unit = self._dataset(name).attrs.get("unit", "1")
        return unit.decode() if isinstance(unit, bytes) else str(unit)

    def under(self, prefix: str) -> dict[str, Any]:
        """The arrays of a group, by what their names have behind `prefix/`."""
        prefix = prefix.rstrip("/") + "/"
        return {name[len(prefix) :]: self[name] for name in self if name.startswith(prefix)}

    @property
    def robots(self) -> list[str]:
        """Their names, in order: robot N is the Nth, from 0."""
        return [str(name) for name in self["robots"]] if "robots" in self else []

    def _group(self, robot: int | str) -> str:
        """robot/N"""
        robots = self.robots
        if isinstance(robot, str) and robot in robots:
            robot = robots.index(robot)
        if not isinstance(robot, int) or not 0 <= robot < len(robots):
            raise KeyError(f"there is no robot {robot!r} in {self.path}, only {', '.join(robots) or 'none'}")
        return f"robot/{robot}"

    def poses(self, robot: int | str = 0) -> Poses:
        """The most likely poses of a robot, by number or name, else the means; of a log its own, else the true ones."""
        group = f"{self._group(robot)}/poses"
        if f"{group}/time_s" not in self:
            group = f"truth/{group}"
        if f"{group}/time_s" not in self:
            raise KeyError(f"there are no poses of robot {robot!r} in {self.path}")
        mode = "mode_" if f"{group}/mode_x_m" in self else ""
        return Poses(self[f"{group}/time_s"], *(self[f"{group}/{mode}{name}"] for name in Poses._fields[1:]))

    def odometry(self, robot: int | str = 0) -> Poses:
        """Where a log's odometry alone leads a robot from (0, 0): its pose at the end of each control."""
        controls = f"{self._group(robot)}/odometry"
        heading: _Column = np.cumsum(self[f"{controls}/turn_rad"])
        forward = self[f"{controls}/forward_m"]
        x, y = np.cumsum(forward * np.cos(heading)), np.cumsum(forward * np.sin(heading))
        return Poses(self[f"{controls}/time_s"], x, y, np.arctan2(np.sin(heading), np.cos(heading)))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws what there is of a map, landmarks and paths, by matplotlib; into a figure of its own without `ax`."""
        from .picture import draw

        return draw(self, ax)

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> File:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<cairn.File {str(self.path)!r}: {self.kind}, {len(self)} arrays>"

    def __str__(self) -> str:
        lines = [f"{self.path}: {self.kind}"]
        for name in self:
            unit = self.unit(name)
            shape = ", ".join(str(n) for n in self.shape(name))
            lines.append(f"  {name} [{shape}]" + (f" {unit}" if unit != "1" else ""))
        return "\n".join(lines)


def _plain(value: Any, scalar: bool) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.ndarray):
        if value.dtype.kind in "SO":  # texts, of fixed width or, as h5py writes them, of none
            value = np.array([text.decode() for text in value.flat], np.str_).reshape(value.shape)
        if scalar:
            return value.flat[0] if value.dtype.kind != "U" else str(value.flat[0])
        value.flags.writeable = False
    return value


def _result_in(folder: Path) -> Path:
    results = sorted(folder.glob("*.h5"))
    if len(results) != 1:
        named = ", ".join(path.name for path in results) or "none"
        raise InputError(f"which file of '{folder}'? It has {named}")
    return results[0]


def read(path: str | os.PathLike[str], *, changed: bool = False) -> File:
    """Opens a file of Cairn's, or the only one in a folder, when its checksum has shown that no byte of it is another.

    changed: take a result although another program has changed it since Cairn wrote it.
    Raises InputError: it is not there, no file of Cairn's, damaged, of a newer format, or changed.
    """
    path = Path(path)
    if path.is_dir():
        path = _result_in(path)
    if not path.is_file():
        raise InputError(f"{path}: {'no regular file' if path.exists() else 'there is no such file'}")
    try:
        with path.open("rb") as bytes_of:
            right = trailer_is_right(bytes_of)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if right is False:
        raise InputError(f"{path}: damaged: its bytes are not those that were written")
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise InputError(f"{path}: no HDF5 file, or a damaged one: {error}") from None
    try:
        kind = _kind_of(path, file.attrs)
        was_changed = right is None and file.attrs.get("cairn_trailer", 0) == 1
        if was_changed and not changed and kind not in _GIVEN:
            raise InputError(
                f"{path}: another program has changed it since Cairn wrote it, so it is not what Cairn computed; "
                "changed=True takes it as it is"
            )
        return File(path, file, kind, was_changed)
    except BaseException:
        file.close()
        raise


def _kind_of(path: Path, attributes: Any) -> str:
    version = attributes.get("cairn_format")
    if not isinstance(version, (int, np.integer)):
        raise InputError(f"{path}: not a Cairn file: it lacks the root attribute cairn_format")
    if version > _FORMAT:
        raise InputError(
            f"{path}: of format {version}, newer than {_FORMAT}, which this version of Cairn reads: install a newer one"
        )
    kind = attributes.get("cairn_kind")
    if isinstance(kind, bytes):
        kind = kind.decode(errors="replace")
    if version < 1 or not isinstance(kind, str):
        raise InputError(f"{path}: not a Cairn file: its root attributes are not as they should be")
    return kind
