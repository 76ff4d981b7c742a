"""Rays of a camera as Mitsuba's arrays, without a copy, or one by one for its scalar variants."""

from __future__ import annotations

import ctypes
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from .._abi import RaysPointers, SamplesPointers, library
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
    written, which are 0. A neighbour that is blocked has weight 0, too, and numbers that mean nothing.
    """
    n = len(samples[0])
    calls = [(list(samples), list(rays))]
    if len(samples) > 5 and len(rays) > 7:
        # At wavelengths the library gives no differentials.
        x, y, *others = samples
        calls = [(list(samples), list(rays[RAY])), ([x + 1, y, *others], list(rays[RIGHT]))]
        calls.append(([x, y + 1, *others], list(rays[DOWN])))
    addresses = [[[column.ctypes.data for column in columns] for columns in call] for call in calls]
    pointer = camera._live().pointer

    def part(begin: int, end: int) -> None:
        for asked, found in addresses:
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
    if differentials and len(sample) > 5:
        x, y, *others = sample
        return [
            number for at in ((x, y), (x + 1, y), (x, y + 1)) for number in trace_one(camera, (*at, *others), False)
        ]
    count = COLUMNS[differentials]
    numbers = (ctypes.c_float * (len(sample) + count))(*sample)
    first = ctypes.addressof(numbers)
    addresses = range(first, first + ctypes.sizeof(numbers), 4)
    _call(camera._live().pointer, 1, addresses[: len(sample)], addresses[len(sample) :])
    return numbers[len(sample) :]


def _call(camera: int, n: int, asked: Sequence[int], found: Sequence[int]) -> None:
    samples = SamplesPointers(*asked[:5])
    # No mint, maxt, time; the weight; no reason.
    ray, *neighbours = (RaysPointers(*found[k : k + 6], 0, 0, 0, found[k + 6], 0) for k in range(0, len(found), 7))
    if neighbours:
        check(library.realistic_camera_generate_ray_differentials_soa(camera, n, samples, ray, *neighbours))
    elif len(asked) > 5:
        check(library.realistic_camera_generate_rays_at_soa(camera, n, samples, asked[5], ray))
    else:
        check(library.realistic_camera_generate_rays_soa(camera, n, samples, ray))
