"""What changes over the field: illumination and distortion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import quietly
from .bundles import bundles_of, in_camera_space, lens_grid, plane_at, seen_from_pinhole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera


def relative_illumination(camera: Camera, image_xy: ArrayLike, *, side: int = 32) -> NDArray[np.float64]:
    """The film's irradiance under an even light, over that in the middle of the picture.

    Parameters
    ----------
    image_xy : array_like (n, 2)
        Film points, pixels.
    side : int
        `side`² lens samples for each.

    Returns
    -------
    ndarray (n,)
        1 in the middle; 0 where nothing gets through.
    """
    with quietly():
        plain = in_camera_space(camera).replace(weighting="radiometric")
    with plain as lit:
        middle = np.array([camera.resolution], np.float64) / 2
        points = np.concatenate([middle, np.asarray(image_xy, np.float64)])
        weight = lit.rays(points[:, None, :], lens_grid(side)[None, :, :]).weight
    light = weight.mean(axis=1, dtype=np.float64)
    if light[0] == 0:
        raise ValueError("no light gets to the middle of the picture")
    relative: NDArray[np.float64] = light[1:] / light[0]
    return relative


def distortion(camera: Camera, radii: ArrayLike, *, distance: float | None = None) -> NDArray[np.float64]:
    """By how much points of a plane of the scene are imaged farther out than near the axis's scale would have it.

    Parameters
    ----------
    radii : array_like (n,)
        Distances from the picture's middle along its diagonal, pixels; positive.
    distance : float, optional
        The plane, as `focusdistance`; default the plane in focus.

    Returns
    -------
    ndarray (n,)
        (r - r') / r', where r' is the radius without distortion: negative is a barrel, positive a pincushion. NaN where
        there is no light.
    """
    width, height = camera.resolution
    diagonal = np.array([width, height]) / np.hypot(width, height)
    r = np.concatenate([[np.hypot(width, height) / 100], np.asarray(radii, np.float64)])
    with in_camera_space(camera) as plain:
        bundles = bundles_of(plain, np.array([width, height]) / 2 + r[:, None] * diagonal, lens_grid(16))
        tangent = np.hypot(*seen_from_pinhole(bundles, plane_at(plain, distance))[0].T)
    relative: NDArray[np.float64] = (r / tangent)[1:] / (r / tangent)[0] - 1
    return relative
