"""What goes wrong, in one sentence."""

from __future__ import annotations


class CairnError(Exception):
    """Something failed through no fault of the input: a full disk, a service that does not answer, no program.

    `exit_code` is the program's, where it ran.
    """

    def __init__(self, message: str, exit_code: int | None = None) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class InputError(CairnError, ValueError):
    """The input is not as it should be: a damaged file, an option that is not known, a log without truth."""


class BusyError(InputError):
    """A folder, or a file, is in use by another process: the same call may be right once that has ended."""
