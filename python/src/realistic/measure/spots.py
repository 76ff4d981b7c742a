"""Spots of object points, and the MTF that follows from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .bundles import bundles_of, in_camera_space, lens_grid, plane_at
from .points import film_points

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera
    from .points import FieldLike


@dataclass(frozen=True, eq=False)
class Spots:
    """Where the rays of object points meet the film.

    Attributes
    ----------
    offset : ndarray (n, m, 2)
        From the middle of each spot, pixels to the right and down.
    weight : ndarray (n, m)
        The rays' weights; 0 for one that is blocked.
    """

    offset: NDArray[np.float64]
    weight: NDArray[np.float64]

    @property
    def rms(self) -> NDArray[np.float64]:
        """The root of the mean square distance from the middle, pixels, (n,); NaN where there is no light."""
        square = (self.offset**2).sum(axis=-1)
        with np.errstate(invalid="ignore"):
            rms: NDArray[np.float64] = np.sqrt((square * self.weight).sum(axis=-1) / self.weight.sum(axis=-1))
        return rms


def spots(camera: Camera, field: FieldLike, *, distance: float | None = None, side: int = 32) -> Spots:
    """The spots of object points that are imaged to some film points.

    Rays are traced from the film to a plane of the scene. By as much as they miss there what their mean meets, in terms of
    what a pixel's step on the film does there, the object point's ray would miss on the film: right to first order in the
    size of the spot.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        The plane, as `focusdistance`; default the plane in focus.
    side : int
        `side`² lens samples for each.
    """
    points, shape = film_points(camera, field, distance)
    found = _spots(camera, points, distance, side)
    return Spots(found.offset.reshape(*shape, side * side, 2), found.weight.reshape(*shape, side * side))


def _spots(camera: Camera, points: NDArray[np.float64], distance: float | None, side: int) -> Spots:
    """The spots of film points (n, 2) in pixels."""
    lens_uv = lens_grid(side)
    with in_camera_space(camera) as plain:
        plane = plane_at(plain, distance)
        bundles = bundles_of(plain, points, lens_uv)
        meets = bundles.points(plane)
        columns = []
        for axis in range(2):
            # Two pixels to either side, as far as the picture goes.
            low, high = points.copy(), points.copy()
            low[:, axis] = np.maximum(points[:, axis] - 2, 0)
            high[:, axis] = np.minimum(points[:, axis] + 2, camera.resolution[axis])
            there, here = (bundles_of(plain, each, lens_uv) for each in (high, low))
            moved = there.mean(there.points(plane)) - here.mean(here.points(plane))
            columns.append(moved / (high - low)[:, axis, None])
    lit = bundles.has_light
    per_pixel = np.stack(columns, axis=-1)
    offset = np.full_like(meets, np.nan)
    missed = meets[lit] - bundles.mean(meets)[lit][:, None]
    offset[lit] = -np.linalg.solve(per_pixel[lit][:, None], missed[..., None])[..., 0]
    return Spots(np.where(bundles.weight[..., None] > 0, offset, 0.0), bundles.weight)


def mtf(
    camera: Camera,
    field: FieldLike,
    frequencies: ArrayLike,
    *,
    distance: float | None = None,
    side: int = 64,
) -> NDArray[np.float64]:
    """The geometric modulation transfer function.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    frequencies : float or array_like (k,)
        Line pairs per mm on the film. Above some side / (width of the spot in mm) the samples are too few.
    distance : float, optional
        The plane of the scene, as `focusdistance`; default the plane in focus.
    side : int
        `side`² lens samples for each film point.

    Returns
    -------
    ndarray (n, 2, k)
        From 1 at frequency 0. First tangential: the pattern changes along the line from the picture's middle; then sagittal:
        across it.
    """
    image_xy, shape = film_points(camera, field, distance)
    found = _spots(camera, image_xy, distance, side)
    mm = found.offset * (camera.film_size_mm[0] / camera.resolution[0])
    radial = image_xy - np.array(camera.resolution) / 2
    length = np.hypot(*radial.T)
    # In the middle both are the same but for the lens samples; any direction will do.
    radial = np.where(length[:, None] > 0, radial / np.maximum(length, 1e-300)[:, None], [0.0, 1.0])
    across = np.stack([-radial[:, 1], radial[:, 0]], axis=-1)
    along = np.stack([(mm * way[:, None]).sum(axis=2) for way in (radial, across)], axis=1)
    lines = np.asarray(frequencies, np.float64)
    waves = np.exp(-2j * np.pi * along[..., None] * lines.ravel())
    weight = found.weight[:, None, :, None]
    with np.errstate(invalid="ignore"):
        transfer: NDArray[np.float64] = np.abs((waves * weight).sum(axis=2)) / weight.sum(axis=2)
    return transfer.reshape(*shape, 2, *lines.shape)
