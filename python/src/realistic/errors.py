"""Exceptions and warnings, with the library's messages."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from ._abi import library


class Error(Exception):
    """The library refused a request; the message says what to change.

    Attributes
    ----------
    status : int
        The `realistic_status` of the C ABI.
    """

    status: int = -1


class ParameterError(Error, ValueError):
    """A parameter is unknown, of the wrong kind, out of range or given twice."""


class LensFileError(Error, ValueError, OSError):
    """The lens description is missing or cannot be read; the message states file, line and column.

    It is both a `ValueError` and an `OSError`, like `io.UnsupportedOperation`, because the library has one status for
    an invalid description and an unreadable file.
    """


class FocusError(Error, ValueError):
    """The lens cannot be focused at the requested distance, or autofocus finds no film distance in any zone."""


class OutOfMemoryError(Error, MemoryError):
    """There is not enough memory for the request."""


class DefectError(Error, RuntimeError):
    """A defect of the library or of this package; please report it."""


class CameraWarning(UserWarning):
    """A warning of the library about a camera that it built."""


# Keyed by the values of `realistic_status`, which never change; other values raise a plain `Error`.
_BY_STATUS: dict[int, type[Error]] = {
    1: DefectError,
    2: DefectError,
    3: ParameterError,
    4: LensFileError,
    5: FocusError,
    7: DefectError,
    8: DefectError,
    9: OutOfMemoryError,
    11: DefectError,
}


def check(status: int) -> None:
    """Raises the exception for a nonzero status, with the message of this thread's last failure."""
    if status != 0:
        message = library.realistic_last_error().decode(errors="replace")
        error = _BY_STATUS.get(status, Error)(message)
        error.status = status
        raise error


# Python's `warnings.catch_warnings` affects all threads; a context variable does not.
_listener: ContextVar[Callable[[str], object] | None] = ContextVar("_listener", default=None)


@contextmanager
def warnings_to(listener: Callable[[str], object]) -> Iterator[None]:
    """Sends the library's warnings to a listener instead of to Python's warnings."""
    before = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(before)


@contextmanager
def quietly() -> Iterator[None]:
    """Suppresses the warnings of cameras that are derived from the caller's camera, which has already issued them."""
    with warnings_to(lambda _message: None):
        yield


def warn(message: str) -> None:
    """Issues a warning at the line outside this package that led to it."""
    listener = _listener.get()
    if listener is not None:
        listener(message)
        return
    level, frame = 1, sys._getframe()
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "realistic":
        level, frame = level + 1, frame.f_back  # type: ignore[assignment]
    warnings.warn(message, CameraWarning, stacklevel=level)
