"""Builds objects of the library, passes on the library's messages, and frees each object with its last reference."""

from __future__ import annotations

import ctypes
import logging
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from ._abi import LOG, Options
from .errors import check

_log = logging.getLogger("realistic")


class Borrowed:
    """A pointer to an object that another owner frees."""

    def __init__(self, pointer: int) -> None:
        self.pointer = pointer


class Handle(Borrowed):
    """A pointer that owns its object and frees it when the last reference to the handle is gone. A call in another
    thread holds a reference, too."""

    def __init__(self, pointer: int, free: Callable[[int], None]) -> None:
        super().__init__(pointer)
        self._free = free

    def __del__(self) -> None:
        self._free(self.pointer)


def build(options: Options, new: Callable[..., int], free: Callable[[int], None]) -> tuple[Handle, list[str]]:
    """Builds an object with the library's function `new`; returns it and the library's warnings. Logs other
    messages."""
    messages: list[tuple[int, str]] = []

    @LOG  # type: ignore[untyped-decorator]
    def log(_user: Any, level: int, message: bytes) -> None:
        messages.append((level, message.decode(errors="replace")))

    options.log = log
    pointer = ctypes.c_void_p()
    with _interrupts_after():
        status = new(ctypes.byref(options), ctypes.byref(pointer))
    handle = Handle(pointer.value, free) if pointer.value is not None else None
    for level, text in messages:
        if level == 0:
            _log.info(text)
    check(status)
    assert handle is not None
    return handle, [text for level, text in messages if level != 0]


@contextmanager
def _interrupts_after() -> Iterator[None]:
    """Defers an interrupt to the end of the block: a `KeyboardInterrupt` raised in a callback of the library would be
    lost."""
    handler = signal.getsignal(signal.SIGINT)
    # Threads other than the main one get no interrupts and may not set a handler.
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    caught: list[FrameType | None] = []
    signal.signal(signal.SIGINT, lambda _number, frame: caught.append(frame))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if caught:
            handler(signal.SIGINT, caught[-1])
