"""Objects of the library's: built with what it tells on the way, and freed with the last reference."""

from __future__ import annotations

import ctypes
import logging
from collections.abc import Callable
from typing import Any

from ._abi import LOG, Options
from .errors import check

_log = logging.getLogger("realistic")


class Borrowed:
    """A pointer to an object that somebody else frees."""

    def __init__(self, pointer: int) -> None:
        self.pointer = pointer


class Handle(Borrowed):
    """A pointer to an object that is freed with the last reference: a call in another thread holds one, too."""

    def __init__(self, pointer: int, free: Callable[[int], None]) -> None:
        super().__init__(pointer)
        self._free = free

    def __del__(self) -> None:
        self._free(self.pointer)


def build(options: Options, new: Callable[..., int], free: Callable[[int], None]) -> tuple[Handle, list[str]]:
    """An object that the library's function `new` builds, and what it warns of; what it tells besides is logged."""
    told: list[str] = []

    @LOG  # type: ignore[untyped-decorator]
    def log(_user: Any, level: int, message: bytes) -> None:
        text = message.decode(errors="replace")
        if level == 0:
            _log.info(text)
        else:
            told.append(text)

    options.log = log
    pointer = ctypes.c_void_p()
    check(new(ctypes.byref(options), ctypes.byref(pointer)))
    assert pointer.value is not None
    return Handle(pointer.value, free), told
