"""Cairn's files as numpy arrays by name (schema/FORMAT.md)."""

from __future__ import annotations

import difflib
import itertools
import math
import os
import re
import zlib
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np
import numpy.typing as npt

from .checksum import fletcher32, trailer_is_right
from .errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FORMAT = 1  # the newest that is known
_GIVEN = ("log", "poses", "samples", "errors")  # kinds that people make, and may change
_MOST_BYTES, _MOST_PACKED = 2 << 30, 100  # as of the program: what is larger, and so many times its file, is none of ours
_MOST_DEFLATED = 1100  # deflate shrinks at most 1032 times
_CHUNK_BYTES = 64 << 20  # a larger chunk than that is none of ours, unless the whole array is
_MOST_LEVELS = 32
_MOST_LISTED = 2000
_SCALED_HEAD = 21  # bytes
_DEFLATE, _SHUFFLE = h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE
_BITS, _SCALED, _SZIP = h5py.h5z.FILTER_NBIT, h5py.h5z.FILTER_SCALEOFFSET, h5py.h5z.FILTER_SZIP
_OF_HDF5 = {_BITS, _SCALED, _SZIP}  # which h5py alone undoes, once it is known how much comes of that
_FILTERS = {_DEFLATE, _SHUFFLE, h5py.h5z.FILTER_FLETCHER32, *_OF_HDF5}
_ANEW = "; ask whoever made the file to write it again with chunks of about 1 MiB (in h5py chunks=True), each filter once"
_ANOTHER = ", which no accident does; ask whoever made the file for another, and let no other program unpack this one"
_MOST_ROWS = 1 << 16  # of texts
_MOST_NAME, _MOST_TEXT, _MOST_DATASET = 256, 4096, 1024  # bytes: of a name, of an element of a list, of a dataset's name
_TURNS = "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"  # the direction of writing, and lines
_CONTROL = re.compile(f"[\x00-\x1f\x7f-\x9f{_TURNS}]")
_CONTROL_IN_LINES = re.compile(f"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f{_TURNS}]")
_UNITS = {  # by what a name ends in, longer endings first
    "_rad_per_sqrt_m": "rad/sqrt(m)",
    "_rad_per_m": "rad/m",
    "_per_m": "1/m",
    "_radps": "rad/s",
    "_mps": "m/s",
    "_rad2": "rad^2",
    "_m2": "m^2",
    "_rad": "rad",
    "_deg": "deg",
    "_hz": "Hz",
    "_bytes": "byte",
    "_px": "px",
    "_nats": "nat",
    "_m": "m",
    "_s": "s",
}
_OTHER_UNITS = {"mm", "cm", "km", "ft", "feet", "in", "inch", "us", "ms", "ns", "min", "degrees", "km/h"}
_Column = npt.NDArray[np.float64]


def _escaped(text: object) -> str:
    """What a stranger wrote, without what a terminal would obey."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in str(text))


def _wrong_with(text: str, most_bytes: int | None, control: re.Pattern[str] = _CONTROL) -> str:
    """As the program says it; "" where nothing is."""
    if most_bytes is not None and len(text.encode(errors="surrogateescape")) > most_bytes:
        return f"is longer than {most_bytes} bytes"
    if not text.isascii() and any("\ud800" <= c <= "\udfff" for c in text):
        return "is not UTF-8"
    return "has control characters" if control.search(text) else ""


def _unit_of(name: str) -> str:
    last = name.rpartition("/")[2]
    return next((unit for ending, unit in _UNITS.items() if last.endswith(ending) or last == ending[1:]), "1")


def _contradicts(name: str, unit: str) -> bool:
    """Whether the array would be read as of another unit than it says."""
    own = _unit_of(name)
    return own not in ("1", unit) and (unit in _OTHER_UNITS or unit in _UNITS.values())


def _text_in(attributes: Any, name: str, otherwise: str | None = None) -> str | None:
    """None where it is no text."""
    value = attributes.get(name, otherwise)
    if isinstance(value, bytes):
        value = value.partition(b"\0")[0].decode(errors="surrogateescape")
    return value if isinstance(value, str) else None


@contextmanager
def _as_input(what: str) -> Iterator[None]:
    """Whatever h5py and numpy make of what a stranger's file holds is InputError."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{_escaped(what)}: {_escaped(error)}") from None


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
        with _as_input(f"{path}: damaged: what is in it cannot be told"):
            self._add_all(file, "")

    def _add_all(self, group: h5py.Group, prefix: str) -> None:
        if prefix.count("/") >= _MOST_LEVELS:  # HDF5 goes each time from the root to what it is asked for
            raise InputError(f"{self.path}: groups within groups, more than {_MOST_LEVELS} deep")
        for name in group:
            if wrong := _wrong_with(prefix + name, _MOST_DATASET):
                raise InputError(f"{self.path}: the name of the dataset '{_escaped(prefix + name)}' {wrong}")
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                raise InputError(f"{self.path}: '{prefix + name}' is a link; Cairn reads what stands there itself")
            item = group[name]
            if h5py.h5o.get_info(item.id).rc > 1:
                raise InputError(f"{self.path}: '{prefix + name}' has two names in this file (a hard link); Cairn reads what has one")
            self._add(prefix + name, item)

    def _add(self, name: str, item: Any) -> None:
        if isinstance(item, h5py.Group):
            self._add_all(item, f"{name}/")
        if not isinstance(item, h5py.Dataset):
            return
        if item.external or item.is_virtual:
            raise InputError(f"{self.path}: the data of '{_escaped(name)}' lie in another file")
        unit = _text_in(item.attrs, "unit", "")
        if unit is not None and (wrong := _wrong_with(unit, _MOST_NAME)):
            raise InputError(f"{self.path}: dataset '{name}': its attribute unit {wrong}")
        if unit is not None and _contradicts(name, unit):
            raise InputError(
                f"{self.path}: dataset '{name}': its attribute unit says {unit}, and its name {_unit_of(name)}, as which it "
                "would be read: convert it, and write that unit, or none"
            )
        self._names[name] = None

    def _dataset(self, name: str) -> h5py.Dataset:
        if name not in self._names:
            near = difflib.get_close_matches(name, self._names, 3)
            meant = f"; is it {' or '.join(repr(n) for n in near)}?" if near else ""
            raise KeyError(f"there is no '{name}' in {self.path}{meant}")
        if not self._file:
            raise InputError(f"{self.path}: it was closed before '{name}' was read")
        with self._reading(name):
            return self._file[name]

    def _reading(self, name: str) -> AbstractContextManager[None]:
        return _as_input(f"{self.path}: damaged: '{name}' cannot be read")

    def __getitem__(self, name: str) -> Any:
        if name not in self._read:
            dataset = self._dataset(name)
            with self._reading(name):
                _check_form(dataset)
                is_texts = dataset.dtype.kind in "SO" and dataset.shape != ()
                given = _put_together(dataset)
                value = _texts(dataset, given) if is_texts else dataset[()] if given is None else given
                plain = _plain(value, bool(dataset.attrs.get("scalar", 0)))
                _check_texts(name, plain)
                self._read[name] = plain
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
        with self._reading(name):
            return () if dataset.attrs.get("scalar", 0) else tuple(dataset.shape)

    def unit(self, name: str) -> str:
        """"m", "rad/m", …; "1" of what has none."""
        dataset = self._dataset(name)
        with self._reading(name):
            unit = _text_in(dataset.attrs, "unit", "1")
            if unit is None:
                raise TypeError("its unit is no text")
            return unit

    def under(self, prefix: str) -> dict[str, Any]:
        """The arrays of a group, by what their names have behind `prefix/`."""
        prefix = prefix.rstrip("/") + "/"
        return {name[len(prefix) :]: self[name] for name in self if name.startswith(prefix)}

    @property
    def robots(self) -> list[str]:
        """Their names, in order: robot N is the Nth, from 0."""
        with self._reading("robots"):
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
        time, turn, forward = (self[f"{controls}/{name}"] for name in ("time_s", "turn_rad", "forward_m"))
        with self._reading(controls):
            heading: _Column = np.cumsum(turn)
            x, y = np.cumsum(forward * np.cos(heading)), np.cumsum(forward * np.sin(heading))
            return Poses(time, x, y, np.arctan2(np.sin(heading), np.cos(heading)))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws what there is of a map, landmarks and paths, by matplotlib; into a figure of its own without `ax`."""
        from .picture import draw

        with _as_input(f"{self.path}: cannot be drawn"):
            return draw(self, ax)

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> File:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<cairn.File {str(self.path)!r}: {_escaped(self.kind)}, {len(self)} arrays>"

    def __str__(self) -> str:
        lines = [f"{self.path}: {self.kind}"]
        for name in self:
            unit = self.unit(name)
            shape = ", ".join(str(n) for n in self.shape(name))
            lines.append(f"  {name} [{shape}]" + (f" {unit}" if unit != "1" else ""))
        return "\n".join(map(_escaped, lines))


def _check_form(dataset: h5py.Dataset) -> None:
    """Before any of it is read."""
    kind, item = dataset.dtype.kind, dataset.dtype.itemsize
    if dataset.shape is None or kind not in "biufSO" or (kind == "O" and h5py.check_string_dtype(dataset.dtype) is None):
        raise TypeError("it holds neither numbers nor texts")
    size, stored = math.prod(dataset.shape) * item, dataset.id.get_storage_size()
    _check_size(dataset, size)
    # Without data HDF5 would give fill values that nobody wrote.
    if size // _MOST_DEFLATED > stored or (size > 0 and stored == 0):
        raise ValueError("its shape and its data do not agree")
    if dataset.chunks is not None and math.prod(dataset.chunks) * item > max(_CHUNK_BYTES, size):
        raise ValueError("its chunks are far larger than it" + _ANEW)


def _put_together(dataset: h5py.Dataset) -> npt.NDArray[Any] | None:
    """Of its chunks, each unpacked once; None: h5py may read it."""
    plan, is_any_text = dataset.id.get_create_plist(), dataset.dtype.kind == "O"
    item = 8 + dataset.file.id.get_create_plist().get_sizes()[0] if is_any_text else dataset.id.get_type().get_size()
    filters = {(given := plan.get_filter(i))[0]: given[2] for i in range(plan.get_nfilters())}
    usual = len(filters) == plan.get_nfilters() and _FILTERS.issuperset(filters)
    others = [of in _OF_HDF5 for of in filters]
    if any(others[1:]) or (any(others) and is_any_text):  # what one makes of a few bytes the next would make large
        usual = False
    if not usual or not (is_any_text or filters.get(_SHUFFLE, (item,)) == (item,)):
        raise ValueError("its filters are none of Cairn's" + _ANEW)
    if _DEFLATE not in filters and not any(others):
        return None
    _check_size(dataset, dataset.id.get_num_chunks() * math.prod(dataset.chunks) * item)
    steps = [range(0, n, chunk) for n, chunk in zip(dataset.shape, dataset.chunks)]
    all_there = dataset.id.get_num_chunks() == math.prod(map(len, steps))
    places = itertools.product(*steps) if all_there else _listed(dataset)
    chunks = ((at, _unpacked(dataset, at, filters, item)) for at in places)
    if any(others) or not all_there or is_any_text or dataset.id.get_type() != h5py.h5t.py_create(dataset.dtype):
        for _ in chunks:  # h5py unpacks them again
            pass
        return None
    values = np.empty(dataset.shape, dataset.dtype)
    for at, data in chunks:
        part = values[tuple(slice(begin, begin + n) for begin, n in zip(at, dataset.chunks))]
        part[...] = np.frombuffer(data, dataset.dtype).reshape(dataset.chunks)[tuple(map(slice, part.shape))]
    return values


def _listed(dataset: h5py.Dataset) -> Iterator[tuple[int, ...]]:
    """Where chunks are, of which some are missing: HDF5 1.10 takes time that grows with the square of their number."""
    if (there := dataset.id.get_num_chunks()) > _MOST_LISTED:
        raise ValueError(f"it lacks some of its chunks, and has more than {_MOST_LISTED}")
    return (dataset.id.get_chunk_info(i).chunk_offset for i in range(there))


def _unpacked(dataset: h5py.Dataset, at: tuple[int, ...], filters: Mapping[int, tuple[int, ...]], item: int) -> bytes:
    """A chunk, of no more bytes than it says: its stream may unpack to as much as its maker likes. b"": h5py may unpack it."""
    size = math.prod(dataset.chunks) * item
    data: bytes
    skipped, data = dataset.id.read_direct_chunk(at)
    if len(data) > 2 * size + 1024:
        raise ValueError("its chunks are more than they unpack to" + _ANEW)
    for i, (of, says) in reversed(list(enumerate(filters.items()))):
        if skipped >> i & 1:
            continue
        if of in _OF_HDF5:
            _check_bits(of, says, data, size, item)
            return b""
        data = _without(of, data, size, item)
    if len(data) != size:
        raise ValueError("its chunks are not of the size that it says")
    return data


def _without(of: int, data: bytes, size: int, item: int) -> bytes:
    if of == _SHUFFLE:
        if rest := len(data) % item:
            return _without(of, data[:-rest], size, item) + data[-rest:]
        planes = np.frombuffer(data, np.uint8).reshape(item, -1)
        if item > 8:
            return planes.T.tobytes()
        together = np.empty(planes.shape[::-1], np.uint8)
        for i, plane in enumerate(planes):  # as above, which would take eight times as long
            together[:, i] = plane
        return together.tobytes()
    if of == h5py.h5z.FILTER_FLETCHER32:
        if fletcher32(data[:-4]) != int.from_bytes(data[-4:], "little"):
            raise ValueError("its checksum is wrong")
        return data[:-4]
    stream = zlib.decompressobj()
    most = size + 4 + _SCALED_HEAD  # with a checksum
    data = stream.decompress(data, most + 1)
    if len(data) > most:
        raise ValueError("it unpacks to more than its shape says" + _ANOTHER)
    if not stream.eof:
        raise ValueError("its data break off")
    return data


def _check_bits(of: int, says: tuple[int, ...], data: bytes, size: int, item: int) -> None:
    """Of what HDF5 itself makes a chunk of: that it makes no more, and reads no further than the data go."""
    count, head = size // item, int.from_bytes(data[:4], "little")
    bits, before = (head, _SCALED_HEAD) if of == _SCALED else (_bits_of(says, item), 0)
    if of == _SZIP:
        right = head <= size
    else:
        right = (says[2:3], says[4:5]) == ((count,), (item,)) and bits <= 8 * item
        right = right and len(data) >= before + (count * bits + 7) // 8
    if not right:
        raise ValueError("its chunks are not of the size that it says")


def _bits_of(says: tuple[int, ...], item: int) -> int:
    """That the n-bit filter keeps of an element: all, or those of a number's precision that lie at an offset."""
    _atomic, _whole = 1, 4
    if says[1:2] == (1,) or says[3:4] == (_whole,):
        return 8 * item
    is_number = len(says) == 8 and says[3] == _atomic and 0 < says[6] and says[6] + says[7] <= 8 * item
    return says[6] if is_number else 8 * item + 1


def _check_size(dataset: h5py.Dataset, size: int) -> None:
    if size > max(_MOST_BYTES, _MOST_PACKED * dataset.file.id.get_filesize()):
        raise ValueError(f"it would take {size} bytes, far more than its file")


def _texts(dataset: h5py.Dataset, given: npt.NDArray[Any] | None) -> npt.NDArray[np.str_]:
    """Of fixed width or, as h5py writes them, of none: the longest is known before there is memory for all."""
    if given is None:
        given = _of_no_width(dataset) if dataset.dtype.kind == "O" else dataset[()]
    values = given.reshape(-1)
    parts = [slice(begin, begin + (1 << 16)) for begin in range(0, len(values), 1 << 16)]
    longest = 1
    for part in parts:
        longest = max(longest, *(len(text.decode()) for text in values[part].tolist()))
        _check_size(dataset, np.dtype("U1").itemsize * longest * len(values))
    texts = np.empty(len(values), f"U{longest}")
    for part in parts:
        texts[part] = [text.decode() for text in values[part].tolist()]
    return texts.reshape(dataset.shape)


def _check_texts(name: str, value: Any) -> None:
    most = _MOST_NAME if name in ("robots", "landmarks", "runs") else _MOST_TEXT
    if isinstance(value, str) and (wrong := _wrong_with(value, None, _CONTROL_IN_LINES)):
        raise ValueError(f"'{value[:_MOST_NAME]}' {wrong}")
    if isinstance(value, np.ndarray) and value.dtype.kind == "U":
        for text in map(str, value.flat):
            if wrong := _wrong_with(text, most):
                raise ValueError(f"'{text[:_MOST_NAME]}' {wrong}")


def _of_no_width(dataset: h5py.Dataset) -> npt.NDArray[np.object_]:
    """In parts: each text is as long as the file at most, but many may be one and the same there."""
    values, held = np.empty(dataset.shape, object), 0
    if dataset.ndim > 1 and math.prod(dataset.shape[:-1]) > _MOST_ROWS:
        raise ValueError("its texts stand in more rows than Cairn's do")
    size, file_bytes = 16, dataset.file.id.get_filesize()
    most = min(max(64, (256 << 20) // file_bytes), 1 << 16)
    for row in np.ndindex(dataset.shape[:-1]):
        begin = 0
        while begin < dataset.shape[-1]:
            part: Any = (*row, slice(begin, begin + size))
            values[part] = dataset[part]
            held += sum(len(text) for text in values[part])
            if held > file_bytes:  # they are never packed
                raise ValueError("its texts are more than its file")
            begin, size = begin + size, min(2 * size, most)
    return values


def _plain(value: Any, scalar: bool) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.ndarray):
        if scalar:
            return value.flat[0] if value.dtype.kind != "U" else str(value.flat[0])
        value.flags.writeable = False
    return value


def _result_in(folder: Path) -> Path:
    results = sorted(folder.glob("*.h5"))
    if len(results) != 1:
        named = ", ".join(_escaped(path.name) for path in results) or "none"
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
    with _as_input(f"{path}: no HDF5 file, or a damaged one"):
        file = h5py.File(path, "r", rdcc_nbytes=_CHUNK_BYTES)  # that none is unpacked twice
    try:
        with _as_input(f"{path}: not a Cairn file: its root attributes are not as they should be"):
            kind = _kind_of(path, file.attrs)
            was_changed = right is None and bool(file.attrs.get("cairn_trailer", 0) == 1)
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
    kind = _text_in(attributes, "cairn_kind")
    if version < 1 or kind is None:
        raise InputError(f"{path}: not a Cairn file: its root attributes are not as they should be")
    if wrong := _wrong_with(kind, _MOST_NAME):
        raise InputError(f"{path}: its root attribute cairn_kind {wrong}")
    return kind
