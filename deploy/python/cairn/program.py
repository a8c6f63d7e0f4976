"""The program `cairn`, by its --json."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

from .errors import BusyError, CairnError, InputError
from .files import File, read

PathLike = Union[str, "os.PathLike[str]"]
_BAD_INPUT = 2  # an exit code
_BUSY = (" is in use by another ", ": locked by a program that writes to it")  # said with it


def command(*words: PathLike) -> Any:
    """What `cairn WORDS… --json` says, from JSON: command("export", "tum", "map", "exported").

    A path that may begin with '-' is no option as a Path, or behind the word "--". What it warns of becomes Python's
    warnings. An interrupt (Ctrl-C), or what else a handler of signals raises, stops the program, and waits until that has
    saved what it had; an interrupt meanwhile ends it at once. It ends with Python, too.
    Raises InputError where the program ends with exit code 2 (BusyError, where it says that another process has the folder
    or file), CairnError with any other, or where it says no JSON; the message is the program's.
    """
    program = shutil.which("cairn")
    if program is None:
        raise CairnError("there is no program 'cairn' on the path: install Cairn, or add its folder to PATH")
    line = [_word(word) for word in words]
    at = line.index("--") if "--" in line else len(line)
    line[at:at] = ["--json", "--die-with-parent"]
    line.insert(0, program)
    # A session of its own: a terminal's Ctrl-C would be a first signal beside ours, and the second ends it unsaved.
    with subprocess.Popen(
        line, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    ) as process:
        try:
            said, complained = process.communicate()
        except BaseException:
            _stop(process)
            raise
    failure = f"{' '.join(line)}: ended with {process.returncode}"
    for complaint in complained.decode(errors="replace").splitlines():
        head, _, tail = complaint.partition(": ")
        if head == "note" or (head == "cairn" and tail.startswith("warning: ")):
            warnings.warn(tail.removeprefix("warning: "), stacklevel=2)
        elif head == "cairn":
            failure = tail
    if process.returncode == 0:
        try:
            return json.loads(said)
        except ValueError:
            raise CairnError(f"{' '.join(line)}: what it says is no JSON") from None
    raise _error_of(failure, process.returncode)


def _error_of(failure: str, exit_code: int) -> CairnError:
    if exit_code != _BAD_INPUT:
        return CairnError(failure, exit_code)
    return (BusyError if any(words in failure for words in _BUSY) else InputError)(failure, exit_code)


def _stop(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGINT)
    try:
        process.communicate()
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
        process.communicate()


def _word(word: PathLike) -> str:
    text = os.fspath(word)
    if text == "":
        raise InputError("a word of a command is empty")
    if "\0" in text:
        raise InputError(f"{text!r}: a word of a command has no zero byte")
    return f"./{text}" if text.startswith("-") and not isinstance(word, str) else text


def _option(name: str, value: Any) -> list[str]:
    """["--name=value"]; [] where it is None or False, as that is not said."""
    if value is None or value is False:
        return []
    flag = "--" + name.replace("_", "-")
    if value is True:
        return [flag]
    text = _text(value)
    if text == "":
        raise InputError(f"{name}: nothing is given (an empty text)")
    return [f"{flag}={text}"]


def _options(named: Mapping[str, Any]) -> list[str]:
    return [word for name, value in named.items() for word in _option(name, value)]


def _text(value: Any) -> str:
    """As the command line takes it: true, 0.25, 0.1,0.2, a path."""
    if hasattr(value, "tolist"):
        value = value.tolist()  # of NumPy
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return ",".join(_text(part) for part in value)
    return str(value)


def _job(
    what: PathLike,
    file: PathLike | None,
    options: Mapping[str, Any] | None,
    inputs: Mapping[str, PathLike] | None,
    seed: int | None,
    units_are_right: bool,
    **more: Any,
) -> list[str]:
    words = [f"--set={name}={_text(value)}" for name, value in (options or {}).items() if value is not None]
    words += [f"--input={name}={os.fspath(path)}" for name, path in (inputs or {}).items()]
    words += _options({"seed": seed, "units_are_right": units_are_right, **more})
    return [*words, "--", os.fspath(what), *([] if file is None else [os.fspath(file)])]


@dataclass(frozen=True)
class Run:
    """A job that was run: `summary` is what `cairn run --json` says, `results` the file of each stage, by its name."""

    summary: dict[str, Any]

    @property
    def results(self) -> dict[str, Path]:
        return {stage["stage"]: Path(stage["result"]) for stage in self.summary["stages"]}

    @property
    def report(self) -> Path | None:
        """The page, with pictures."""
        return Path(self.summary["report"]) if self.summary["report"] else None

    def read(self, stage: str | None = None) -> File:
        """The result of a stage, without a name that of the last one."""
        results = self.results
        if stage is not None and stage not in results:
            raise KeyError(f"there is no stage '{stage}', only {', '.join(results)}")
        return read(results[stage] if stage is not None else list(results.values())[-1])


def run(
    what: PathLike,
    file: PathLike | None = None,
    *,
    out: PathLike | None = None,
    options: Mapping[str, Any] | None = None,
    inputs: Mapping[str, PathLike] | None = None,
    seed: int | None = None,
    workers: int | None = None,
    force: bool = False,
    units_are_right: bool = False,
) -> Run:
    """Runs a job here, until it is done: `cairn run`. The same call again resumes it, or finds it finished.

    what: a job file, or the name of a pipeline, which reads `file`; its options and further inputs are by name.
    out: the folder of the results, else the job's name. force: forget what an earlier run left there.
    """
    try:
        _text(out).encode()
    except UnicodeEncodeError:
        raise InputError("out: is not UTF-8, as what the program says of it is") from None
    words = _job(what, file, options, inputs, seed, units_are_right, out=out, workers=workers, force=force)
    return Run(command("run", *words))


def submit(
    what: PathLike,
    file: PathLike | None = None,
    *,
    options: Mapping[str, Any] | None = None,
    inputs: Mapping[str, PathLike] | None = None,
    seed: int | None = None,
    units_are_right: bool = False,
    **more: Any,
) -> dict[str, Any]:
    """Hands a job and its inputs to a coordinator: `cairn submit`.

    more: its further options, priority=2, connect="tcp://hub:5570", key=, server_key=, name=. The dict is what
    `cairn status JOB --json` says, its `id` the JOB of other commands. Who submits the same again is told of the job that is
    there.
    """
    job: dict[str, Any] = command("submit", *_job(what, file, options, inputs, seed, units_are_right, **more))
    return job


def submit_each(
    what: PathLike,
    files: PathLike,
    *,
    options: Mapping[str, Any] | None = None,
    inputs: Mapping[str, PathLike] | None = None,
    seed: int | None = None,
    units_are_right: bool = False,
    **more: Any,
) -> list[dict[str, Any]]:
    """Hands a job for each file that matches a pattern ("logs/*.h5") to a coordinator: `cairn submit --each`.

    All are looked at before the first is handed in. As submit() otherwise, a dict for each.
    """
    words = _job(what, None, options, inputs, seed, units_are_right, each=files, **more)
    jobs: list[dict[str, Any]] = command("submit", *words)
    return jobs


def evaluate(result: PathLike, truth: PathLike | None = None, **options: Any) -> dict[str, Any]:
    """Scores a result against what it is known to be: `cairn evaluate RESULT --truth TRUTH`.

    options: those of the command, `nearest=3` as `--nearest 3`, `changed=True` as `--changed`.
    """
    scores: dict[str, Any] = command("evaluate", *_options({"truth": truth, **options}), "--", os.fspath(result))
    return scores
