"""Rays of a camera as Mitsuba's arrays, without a copy, or one by one for its scalar variants."""

from __future__ import annotations

import ctypes
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from .._abi import Input, Output, Request, library
from ..errors import check

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ..camera import Camera

RAY = slice(0, 7)
"""The columns of a ray: origin, direction, weight."""
RIGHT, DOWN = slice(7, 14), slice(14, 21)
"""Those of its neighbours, one pixel to the right and one pixel down."""

COLUMNS = {False: 7, True: 21}
"""How many columns there are, without and with differentials."""

# Fewer rays than this are not worth another thread.
_SHARE = 16384


def trace(camera: Camera, samples: Sequence[NDArray[Any]], rays: Sequence[NDArray[Any]], threads: int) -> None:
    """Writes the rays of samples, on some threads.

    All are columns (n,) of float32 without gaps: `samples` image x, image y, lens u, lens v, time and, for rays at
    wavelengths, those in nm; `rays` those of `RAY` or of `RAY`, `RIGHT` and `DOWN`. Of a blocked ray only the weights are
    written, which are 0. A neighbour that is blocked has weight 0, too, and the ray's own numbers in its place.
    """
    n = len(samples[0])
    asked, found = ([column.ctypes.data for column in columns] for columns in (samples, rays))
    pointer = camera._live().pointer

    def part(begin: int, end: int) -> None:
        _call(pointer, end - begin, [at + 4 * begin for at in asked], [at + 4 * begin for at in found])

    parts = max(1, min(threads, n // _SHARE))
    edges = [n * k // parts for k in range(parts + 1)]
    if parts == 1:
        part(0, n)
    else:
        with ThreadPoolExecutor(parts) as pool:
            list(pool.map(part, edges[:-1], edges[1:]))


def trace_one(camera: Camera, sample: Sequence[float], differentials: bool) -> list[float]:
    """One ray: its numbers in the order of `trace`'s columns."""
    count = COLUMNS[differentials]
    numbers = (ctypes.c_float * (len(sample) + count))(*sample)
    first = ctypes.addressof(numbers)
    addresses = range(first, first + ctypes.sizeof(numbers), 4)
    _call(camera._live().pointer, 1, addresses[: len(sample)], addresses[len(sample) :])
    return numbers[len(sample) :]


def _call(camera: int, n: int, asked: Sequence[int], found: Sequence[int]) -> None:
    request = Request(struct_size=ctypes.sizeof(Request))
    image_x, image_y, lens_u, lens_v, time, *wavelengths = asked
    request.image, request.lens = Input(image_x, image_y, 4), Input(lens_u, lens_v, 4)
    request.time = Input(time, None, 4)
    if wavelengths:
        request.wavelength = Input(wavelengths[0], None, 4)
    for prefix, k in (("", 0), ("rx_", 7), ("ry_", 14)):
        if k < len(found):
            setattr(request, f"{prefix}origin", Output(*found[k : k + 3], 4))
            setattr(request, f"{prefix}direction", Output(*found[k + 3 : k + 6], 4))
            setattr(request, f"{prefix}weight", Output(found[k + 6], None, None, 4))
    check(library.realistic_camera_generate_batch(camera, n, request))
