"""Measures that vary over the field: illumination and distortion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import quietly
from .bundles import bundles_of, in_camera_space, lens_grid, pinhole, plane_at, seen_from
from .points import film_points

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..camera import Camera
    from .points import FieldLike


def relative_illumination(camera: Camera, field: FieldLike, *, side: int = 32) -> NDArray[np.float64]:
    """Returns the film's irradiance under uniform light, relative to the middle of the picture.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    side : int
        Square root of the number of lens samples for each field point.

    Returns
    -------
    ndarray (n,)
        1 in the middle; 0 where no light passes the lens.
    """
    image_xy, shape = film_points(camera, field, None)
    with in_camera_space(camera) as plain:
        with quietly():
            lit = plain.replace(weighting="radiometric")
        middle = np.array([camera.resolution], np.float64) / 2
        points = np.concatenate([middle, image_xy])
        weight = lit.rays(points[:, None, :], lens_grid(side)[None, :, :]).weight
    light = weight.mean(axis=1, dtype=np.float64)
    if light[0] == 0:
        raise ValueError("no light gets to the middle of the picture")
    relative: NDArray[np.float64] = light[1:] / light[0]
    return relative.reshape(shape)


def distortion(camera: Camera, field: FieldLike, *, distance: float | None = None) -> NDArray[np.float64]:
    """Returns the distortion: the relative difference of image heights from those that the image scale on the axis
    gives.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        Distance of the plane in the scene, given like `focus_distance`; default the plane in focus.

    Returns
    -------
    ndarray (n,)
        (r - r') / r', where r is the distance from the picture's middle and r' what this distance would be without
        distortion: negative for barrel, positive for pincushion distortion. 0 in the middle; NaN where there is no
        light.
    """
    image_xy, shape = film_points(camera, field, distance)
    width, height = camera.resolution
    middle = np.array([width, height]) / 2
    radii = np.hypot(*(image_xy - middle).T)
    away = (image_xy - middle) / np.maximum(radii, 1e-300)[:, None]
    # The scale is taken near the axis, in the direction of each point, because pixels need not be square.
    near = np.hypot(width, height) / 100
    points = np.concatenate([middle + near * away, image_xy])
    with in_camera_space(camera) as plain:
        plane = plane_at(plain, distance)
        seen = seen_from(bundles_of(plain, points, lens_grid(16)), pinhole(plain, plane), plane)
    there, here = np.hypot(*seen.T).reshape(2, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(radii > 0, (radii / here) / (near / there) - 1, 0.0)
    return relative.reshape(shape)
