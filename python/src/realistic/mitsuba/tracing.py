"""Rays of a camera, and directions toward it, as Mitsuba's arrays, without a copy, or one by one for its scalar variants."""

from __future__ import annotations

import ctypes
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from .._abi import (
    AimedPointers,
    ImportancePointers,
    Input,
    Output,
    Request,
    ScenePointsPointers,
    library,
)
from ..errors import check

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from ..camera import Camera

RAY = slice(0, 7)
"""The columns of a ray: origin, direction, weight."""
RIGHT, DOWN = slice(7, 14), slice(14, 21)
"""Those of its neighbours, one pixel to the right and one pixel down."""

COLUMNS = {False: 7, True: 21}
"""How many columns there are, without and with differentials."""

AIM = 10
"""How many columns a direction toward the lens has: where it meets the front, direction, density, image x, image y, importance."""

# Fewer rays than this are not worth another thread.
_SHARE = 16384


def trace(camera: Camera, samples: Sequence[NDArray[Any]], rays: Sequence[NDArray[Any]], threads: int) -> None:
    """Writes the rays of samples, on some threads.

    All are columns (n,) of float32 without gaps: `samples` image x, image y, lens u, lens v, time and, for rays at
    wavelengths, those in nm; `rays` those of `RAY` or of `RAY`, `RIGHT` and `DOWN`. Of a blocked ray only the weights are
    written, which are 0. A neighbour that is blocked has weight 0, too, and the ray's own numbers in its place.
    """
    _in_parts(_call, camera, samples, rays, threads)


def aim(camera: Camera, points: Sequence[NDArray[Any]], found: Sequence[NDArray[Any]], threads: int) -> None:
    """Writes the directions from points of the scene toward the lens, on some threads.

    All are columns (n,) of float32 without gaps: `points` x, y, z, u, v and time, in the unit of the camera's shutter, and
    `found` the numbers of `AIM`.
    """
    _in_parts(_call_aim, camera, points, found, threads)


def _in_parts(
    call: Callable[[int, int, Sequence[int], Sequence[int]], None],
    camera: Camera,
    given: Sequence[NDArray[Any]],
    taken: Sequence[NDArray[Any]],
    threads: int,
) -> None:
    """Makes a call of columns in parts, each on a thread."""
    n = len(given[0])
    asked, found = ([column.ctypes.data for column in columns] for columns in (given, taken))
    pointer = camera._live().pointer

    def part(begin: int, end: int) -> None:
        call(pointer, end - begin, [at + 4 * begin for at in asked], [at + 4 * begin for at in found])

    parts = max(1, min(threads, n // _SHARE))
    edges = [n * k // parts for k in range(parts + 1)]
    if parts == 1:
        part(0, n)
    else:
        with ThreadPoolExecutor(parts) as pool:
            list(pool.map(part, edges[:-1], edges[1:]))


def trace_one(camera: Camera, sample: Sequence[float], differentials: bool) -> list[float]:
    """One ray: its numbers in the order of `trace`'s columns."""
    return _one(_call, camera, sample, COLUMNS[differentials])


def aim_one(camera: Camera, point: Sequence[float]) -> list[float]:
    """One direction toward the lens: its numbers in the order of `aim`'s columns."""
    return _one(_call_aim, camera, point, AIM)


def _one(
    call: Callable[[int, int, Sequence[int], Sequence[int]], None], camera: Camera, given: Sequence[float], count: int
) -> list[float]:
    numbers = (ctypes.c_float * (len(given) + count))(*given)
    first = ctypes.addressof(numbers)
    addresses = range(first, first + ctypes.sizeof(numbers), 4)
    call(camera._live().pointer, 1, addresses[: len(given)], addresses[len(given) :])
    return numbers[len(given) :]


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


def _call_aim(camera: int, n: int, asked: Sequence[int], found: Sequence[int]) -> None:
    points = ScenePointsPointers(ctypes.sizeof(ScenePointsPointers), *asked)
    aimed = AimedPointers(ctypes.sizeof(AimedPointers), *found[:7])
    importance = ImportancePointers(ctypes.sizeof(ImportancePointers), *found[7:10])
    check(library.realistic_camera_sample_importance(camera, n, points, aimed, importance))
