"""Cairn from Python: reads its files as numpy arrays, and runs its program.

    import cairn

    log = cairn.read("log.h5")
    done = cairn.run("landmark_map", "log.h5", out="map")
    result = done.read()
    print(result["map/landmark_x_m"], result.unit("map/landmark_x_m"))
    print(cairn.evaluate("map", truth="log.h5")["landmarks"])
    result.plot()

Files are those of schema/FORMAT.md. Reading needs h5py and numpy, plot() also matplotlib, all else the program
`cairn` on the path.
"""

try:
    import h5py as _h5py  # noqa: F401
except ImportError as _error:
    raise ImportError("cairn needs h5py and numpy: apt install python3-h5py, or pip install h5py") from _error

from .errors import BusyError, CairnError, InputError
from .files import File, Poses, read
from .program import Run, command, evaluate, run, submit, submit_each

__all__ = [
    "BusyError",
    "CairnError",
    "File",
    "InputError",
    "Poses",
    "Run",
    "command",
    "evaluate",
    "read",
    "run",
    "submit",
    "submit_each",
]
