"""Traces rays of a camera, and directions toward it, in Mitsuba's arrays without a copy; for scalar variants, one by
one."""

from __future__ import annotations

import ctypes
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from .._abi import (
    AimedView,
    ImportanceView,
    Input,
    Output,
    Request,
    ScenePointsView,
    library,
)
from ..errors import check, quietly

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from ..camera import Camera

RAY = slice(0, 7)
"""The columns of a ray: origin, direction, weight."""
RIGHT, DOWN = slice(7, 14), slice(14, 21)
"""The columns of the ray's neighbours, one pixel to the right and one pixel down."""

COLUMNS = {False: 7, True: 21}
"""Number of columns, without and with differentials."""

AIM = 10
"""Number of columns of a direction toward the lens: point on its front, direction, density, image xy, importance."""

# Fewer rays than this are not worth another thread.
_SHARE = 16384

# Parameters that may block rays of a film point that gets light. The camera that traces the replacements of blocked
# rays omits these parameters.
_BLOCKING = ("pupil", "shutter", "shutter_ramp", "shutter_slit", "ghosts")


class Tracer:
    """Traces a camera's rays. A blocked ray has weight 0 and the direction in which its film point looks.

    Some outputs of a renderer, such as the depth and the derivatives of texture coordinates of Mitsuba's integrator
    `aov`, are not multiplied by the weight of a ray. Such outputs need a direction and differentials even for blocked
    rays. So the ray through the middle of the film point's pupil replaces a blocked ray. A film point that gets no
    light at all has no such ray; there the replacement is the ray of a pinhole at the front vertex, with the focal
    length of the lens.
    """

    def __init__(self, camera: Camera) -> None:
        self.camera = camera
        given = [name for name in _BLOCKING if name in camera.parameters]
        with quietly():
            self._open = camera.replace(**dict.fromkeys(given)) if given else camera
        focal_length = camera.focal_length_mm
        # An afocal lens, with infinite focal length, sees straight ahead.
        self._pixels = np.hypot(*camera.resolution) / camera.film_diagonal * abs(focal_length)

    def trace(self, samples: Sequence[NDArray[Any]], rays: Sequence[NDArray[Any]], threads: int) -> None:
        """Writes the rays of samples, on some threads.

        All arrays are contiguous columns (n,) of float32. `samples` are image x, image y, lens u, lens v, time and, for
        rays at given wavelengths, the wavelength in nm; `rays` are the columns of `RAY`, or of `RAY`, `RIGHT` and
        `DOWN`. A blocked neighbour has weight 0 and the ray's own origin and direction.
        """
        _in_parts(_call, self.camera, samples, rays, threads)
        blocked = np.flatnonzero(rays[6] == 0)
        if len(blocked):
            again = [column[blocked] for column in samples]
            again[2][:] = again[3][:] = 0.5
            for column, other in zip(rays, self._replacements(again, len(rays), threads)):
                column[blocked] = other

    def trace_one(self, sample: Sequence[float], differentials: bool) -> list[float]:
        """Returns one ray, as numbers in the order of `trace`'s columns."""
        found = _one(_call, self.camera, sample, COLUMNS[differentials])
        if found[6] == 0:
            again = np.array([*sample[:2], 0.5, 0.5, *sample[4:]], np.float32)
            found = self._replacements(list(again[:, None]), len(found), 1)[:, 0].tolist()
        return found

    def _replacements(self, samples: Sequence[NDArray[Any]], count: int, threads: int) -> NDArray[np.float32]:
        """Returns the columns of the rays that replace blocked ones; all weights are 0."""
        found = np.zeros((count, len(samples[0])), np.float32)
        _in_parts(_call, self._open, samples, list(found), threads)
        dark = found[6] == 0
        for at, (right, down) in zip(range(0, count, 7), ((0, 0), (1, 0), (0, 1))):
            found[at : at + 6, dark] = self._pinhole(samples[0][dark] + right, samples[1][dark] + down)
            found[at + 6] = 0
        return found

    def _pinhole(self, image_x: NDArray[Any], image_y: NDArray[Any]) -> NDArray[np.float64]:
        """Returns origins and directions, (6, n), of the rays of a pinhole at the front vertex."""
        width, height = self.camera.resolution
        across, up = image_x - 0.5 * width, 0.5 * height - image_y
        inside = np.stack([across / self._pixels, up / self._pixels, np.ones(len(image_x))])
        pose = self.camera._pose.get("camera_to_world", np.eye(4))
        direction = pose[:3, :3] @ (inside / np.linalg.norm(inside, axis=0))
        origin = np.broadcast_to(pose[:3, 3:], direction.shape)
        return np.concatenate([origin, direction / np.linalg.norm(direction, axis=0)])


def aim(camera: Camera, points: Sequence[NDArray[Any]], found: Sequence[NDArray[Any]], threads: int) -> None:
    """Writes the directions from scene points toward the lens, on some threads.

    All arrays are contiguous columns (n,) of float32. `points` are x, y, z, u, v and the time as a fraction of the
    shutter's interval; `found` are the columns of `AIM`.
    """
    _in_parts(_call_aim, camera, points, found, threads)


def _in_parts(
    call: Callable[[int, int, Sequence[int], Sequence[int]], None],
    camera: Camera,
    given: Sequence[NDArray[Any]],
    taken: Sequence[NDArray[Any]],
    threads: int,
) -> None:
    """Splits a call for columns into parts and runs each part on its own thread."""
    n = len(given[0])
    inputs, outputs = ([column.ctypes.data for column in columns] for columns in (given, taken))
    pointer = camera._live().pointer

    def part(begin: int, end: int) -> None:
        call(pointer, end - begin, [at + 4 * begin for at in inputs], [at + 4 * begin for at in outputs])

    parts = max(1, min(threads, n // _SHARE))
    edges = [n * k // parts for k in range(parts + 1)]
    if parts == 1:
        part(0, n)
    else:
        with ThreadPoolExecutor(parts) as pool:
            list(pool.map(part, edges[:-1], edges[1:]))


def aim_one(camera: Camera, point: Sequence[float]) -> list[float]:
    """Returns one direction toward the lens, as numbers in the order of `aim`'s columns."""
    return _one(_call_aim, camera, point, AIM)


def _one(
    call: Callable[[int, int, Sequence[int], Sequence[int]], None], camera: Camera, given: Sequence[float], count: int
) -> list[float]:
    numbers = (ctypes.c_float * (len(given) + count))(*given)
    first = ctypes.addressof(numbers)
    addresses = range(first, first + ctypes.sizeof(numbers), 4)
    call(camera._live().pointer, 1, addresses[: len(given)], addresses[len(given) :])
    return numbers[len(given) :]


def _call(camera: int, n: int, inputs: Sequence[int], outputs: Sequence[int]) -> None:
    request = Request(struct_size=ctypes.sizeof(Request))
    image_x, image_y, lens_u, lens_v, time, *wavelengths = inputs
    request.image, request.lens = Input(image_x, image_y, None, 4), Input(lens_u, lens_v, None, 4)
    request.time = Input(time, None, None, 4)
    if wavelengths:
        request.wavelength = Input(wavelengths[0], None, None, 4)
    for prefix, k in (("", 0), ("rx_", 7), ("ry_", 14)):
        if k < len(outputs):
            setattr(request, f"{prefix}origin", Output(*outputs[k : k + 3], 4))
            setattr(request, f"{prefix}direction", Output(*outputs[k + 3 : k + 6], 4))
            setattr(request, f"{prefix}weight", Output(outputs[k + 6], None, None, 4))
    check(library.realistic_camera_generate_batch(camera, n, request))


def _call_aim(camera: int, n: int, inputs: Sequence[int], outputs: Sequence[int]) -> None:
    x, y, z, u, v, time = inputs
    ox, oy, oz, dx, dy, dz, density, image_x, image_y, importance = outputs
    points = ScenePointsView(
        ctypes.sizeof(ScenePointsView), Input(x, y, z, 4), Input(u, v, None, 4), Input(time, None, None, 4)
    )
    aimed = AimedView(
        ctypes.sizeof(AimedView), Output(ox, oy, oz, 4), Output(dx, dy, dz, 4), Output(density, None, None, 4)
    )
    counted = ImportanceView(
        ctypes.sizeof(ImportanceView), Output(image_x, image_y, None, 4), Output(importance, None, None, 4)
    )
    check(library.realistic_camera_sample_importance(camera, n, points, aimed, counted))
