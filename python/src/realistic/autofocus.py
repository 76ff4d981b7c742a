"""Autofocus: finds the film distance from scene distances, or from picture contrast, that the caller measures."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ._abi import CONTRAST, DISTANCE, Options, Zone, library
from .errors import check

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

RULES = ("nearest", "centre", "average")
"""Names of the values of `realistic_autofocus_rule`, indexed by value."""


def film_distance(
    options: Options,
    zones: ArrayLike,
    rule: str,
    distance: Callable[[NDArray[np.float32], NDArray[np.float32]], float | None] | None,
    contrast: Callable[[int, tuple[float, float, float, float]], float | None] | None,
) -> float:
    """Returns the film distance, mm, as `Camera.autofocus` does; but `contrast` gets the address of a camera here."""
    if rule not in RULES:
        raise ValueError(f"rule is {rule!r}; give one of {', '.join(map(repr, RULES))}")
    rows = np.asarray(zones, np.float32)
    if rows.ndim != 2 or rows.shape[1] != 4:
        raise ValueError(f"zones must have shape (n, 4): left, top, right, bottom; this array has {rows.shape}")
    failures: list[BaseException] = []

    def answer(function: Callable[..., float | None], *arguments: Any) -> float:
        """Calls the caller's function until it raises an exception; keeps the exception, which must not pass through
        the library."""
        if failures:
            return float("nan")
        try:
            found = function(*arguments)
            return float("nan") if found is None else float(found)
        except BaseException as failure:  # noqa: BLE001  Raised again below, interrupts included.
            failures.append(failure)
            return float("nan")

    @DISTANCE  # type: ignore[untyped-decorator]
    def on_distance(_user: Any, ray: Any) -> float:
        o, d = ray.contents.o, ray.contents.d
        return answer(distance, np.array(o, np.float32), np.array(d, np.float32))  # type: ignore[arg-type]

    @CONTRAST  # type: ignore[untyped-decorator]
    def on_contrast(_user: Any, camera: int, zone: Any) -> float:
        z = zone.contents
        return answer(contrast, camera, (z.left, z.top, z.right, z.bottom))  # type: ignore[arg-type]

    found = ctypes.c_double()
    status = library.realistic_autofocus(
        ctypes.byref(options),
        (Zone * len(rows))(*(Zone(*row.tolist()) for row in rows)),
        len(rows),
        RULES.index(rule),
        on_distance if distance is not None else DISTANCE(),
        on_contrast if contrast is not None else CONTRAST(),
        None,
        ctypes.byref(found),
    )
    if failures:
        raise failures[0]
    check(status)
    return found.value
