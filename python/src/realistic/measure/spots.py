"""Spots of object points, and the MTF that follows from them by geometric optics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import warn
from .bundles import Bundles, bundles_of, in_camera_space, plane_at, pupil_rule
from .diffraction import fnumber_if_lit, mtf_at, wavelength_of
from .points import film_points

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera
    from .points import FieldLike


SIDE = 48
"""Square root of the number of rays per object point, for every spot and MTF."""


@dataclass(frozen=True, eq=False)
class Spots:
    """The points where the rays of object points meet the film.

    Attributes
    ----------
    offset : ndarray (n, m, 2)
        Offset from the centroid of each spot, pixels to the right and down.
    weight : ndarray (n, m)
        Share of the light that each ray represents, for an object point that radiates equally in all directions; 0 for
        a blocked ray. Only ratios matter.
    """

    offset: NDArray[np.float64]
    weight: NDArray[np.float64]

    @property
    def rms(self) -> NDArray[np.float64]:
        """Root mean square distance from the centroid, pixels, (n,); NaN where there is no light.

        The mean is over the object point's light, which fills the entrance pupil evenly as seen from that point.
        `realistic export --as spot` reports the same number.
        """
        square = (self.offset**2).sum(axis=-1)
        with np.errstate(invalid="ignore"):
            rms: NDArray[np.float64] = np.sqrt((square * self.weight).sum(axis=-1) / self.weight.sum(axis=-1))
        return rms


def spots(camera: Camera, field: FieldLike, *, distance: float | None = None, side: int = SIDE) -> Spots:
    """Returns the spots of object points that are imaged to some film points.

    An object point is the point where the mean of a film point's rays meets a plane of the scene. For each lens sample,
    a search finds the film point whose ray meets the object point, and the light that this ray carries from the object
    point.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        Distance of the plane in the scene, given like `focus_distance`; default the plane in focus.
    side : int
        Square root of the number of lens samples per point, on radii of the pupil; even. The default gives the RMS to
        three digits.

    Raises
    ------
    ValueError
        For an odd `side`, or one below 4.
    """
    points, shape = film_points(camera, field, distance)
    found = _spots(camera, points, distance, side)
    return Spots(found.offset.reshape(*shape, side * side, 2), found.weight.reshape(*shape, side * side))


def _spots(camera: Camera, points: NDArray[np.float64], distance: float | None, side: int) -> Spots:
    """Returns the spots of film points (n, 2) in pixels."""
    if side < 4 or side % 2:
        raise ValueError(f"side is {side}; give an even number, 4 or more")
    with in_camera_space(camera) as plain:
        plane = plane_at(plain, distance)
        lens_uv, share = pupil_rule(plain, points, side)
        bundles = bundles_of(plain, points, lens_uv)
        light = bundles.weight * share
        target = _mean(bundles.points(plane), light)
        # Two Newton steps: the first is accurate to first order in the size of the spot, and is the start of the
        # second.
        film = np.broadcast_to(points[:, None], (*lens_uv.shape[:2], 2))
        for _ in range(2):
            bundles, per_pixel, passed = _steps(plain, film, lens_uv, plane)
            missed = target - bundles.points(plane)
            (ax, ay), (bx, by) = (np.moveaxis(step, -1, 0) for step in per_pixel)
            area = ax * by - ay * bx
            x = (by * missed[..., 0] - bx * missed[..., 1]) / area
            y = (ax * missed[..., 1] - ay * missed[..., 0]) / area
            moved = np.where(passed[..., None], film + np.stack([x, y], axis=-1), points[:, None])
            film = np.clip(moved, 0, camera.resolution)
    # A ray has the same étendue on both sides of the lens. So the smaller the area of the plane that a pixel sees along
    # a ray, the more light from a point of the plane follows this ray.
    light = np.where(passed, bundles.weight * share, 0.0) / np.abs(area)
    if np.isfinite(plane):
        light *= np.hypot(1.0, np.hypot(bundles.slope[..., 0], bundles.slope[..., 1]))
    offset = moved - _mean(moved, light)
    return Spots(np.where(passed[..., None], offset, 0.0), light)


def _steps(
    plain: Camera, film: NDArray[np.float64], lens_uv: NDArray[np.float32], plane: float
) -> tuple[Bundles, list[NDArray[np.float64]], NDArray[np.bool_]]:
    """Returns the rays of film points (n, m, 2), their shifts in the plane per pixel to the right and per pixel down,
    and a mask of the rays that pass together with their neighbours. The other rays get unit shifts."""
    bundles = bundles_of(plain, film, lens_uv)
    steps, passed = [], bundles.weight > 0
    for axis in range(2):
        # Two pixels to either side, within the picture.
        low, high = film.copy(), film.copy()
        low[..., axis] = np.maximum(film[..., axis] - 2, 0)
        high[..., axis] = np.minimum(film[..., axis] + 2, plain.resolution[axis])
        there, here = (bundles_of(plain, each, lens_uv) for each in (high, low))
        steps.append((there.points(plane) - here.points(plane)) / (high - low)[..., axis, None])
        passed &= (there.weight > 0) & (here.weight > 0)
    return bundles, [np.where(passed[..., None], step, unit) for step, unit in zip(steps, np.eye(2))], passed


def _mean(values: NDArray[np.float64], light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the mean, (n, 1, 2), of values (n, m, 2) over the lens samples, weighted by light; NaN without light."""
    with np.errstate(invalid="ignore"):
        mean: NDArray[np.float64] = np.einsum("nmk,nm->nk", values, light) / light.sum(axis=1)[:, None]
    return mean[:, None]


def mtf(
    camera: Camera,
    field: FieldLike,
    frequencies: ArrayLike,
    *,
    distance: float | None = None,
    side: int = SIDE,
) -> NDArray[np.float64]:
    """Returns the geometric modulation transfer function of the spots of `spots`, without diffraction.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    frequencies : float or array_like (k,)
        Line pairs per mm on the film. Above about side / (width of the spot in mm) the samples are too few.
    distance : float, optional
        Distance of the plane in the scene, given like `focus_distance`; default the plane in focus.
    side : int
        Square root of the number of lens samples per film point; even.

    Returns
    -------
    ndarray (n, 2, k)
        Modulation, 1 at frequency 0. The first row is tangential, for a pattern that varies along the line from the
        picture's middle; the second is sagittal, for a pattern that varies across that line.

    Warns
    -----
    realistic.CameraWarning
        If the geometric MTF exceeds `diffraction_mtf`, which no lens of this f-number can exceed.
    """
    image_xy, shape = film_points(camera, field, distance)
    lines = np.asarray(frequencies, np.float64)
    transfer = transfer_of(camera, image_xy, _spots(camera, image_xy, distance, side), lines.ravel())
    _warn_beyond_diffraction(camera, transfer, lines.ravel())
    return transfer.reshape(*shape, 2, *lines.shape)


def transfer_of(
    camera: Camera, image_xy: NDArray[np.float64], found: Spots, lines: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns the geometric MTF, (n, 2, k), of the spots of film points (n, 2) at frequencies (k,)."""
    mm = found.offset * (camera.film_size_mm[0] / camera.resolution[0])
    radial = image_xy - np.array(camera.resolution) / 2
    length = np.hypot(*radial.T)
    # In the picture's middle, both curves are the same except for sampling error, so any direction will do.
    radial = np.where(length[:, None] > 0, radial / np.maximum(length, 1e-300)[:, None], [0.0, 1.0])
    across = np.stack([-radial[:, 1], radial[:, 0]], axis=-1)
    along = np.stack([(mm * direction[:, None]).sum(axis=2) for direction in (radial, across)], axis=1)
    waves = np.exp(-2j * np.pi * along[..., None] * lines)
    weight = found.weight[:, None, :, None]
    with np.errstate(invalid="ignore"):
        transfer: NDArray[np.float64] = np.abs((waves * weight).sum(axis=2)) / weight.sum(axis=2)
    return transfer


def _warn_beyond_diffraction(camera: Camera, transfer: NDArray[np.float64], lines: NDArray[np.float64]) -> None:
    """Warns of the frequency at which a geometric MTF (n, 2, k) is farthest above the diffraction limit."""
    if camera.interfaces == 0 or lines.size == 0 or not np.isfinite(transfer).any():
        return
    number = fnumber_if_lit(camera)
    if np.isinf(number):
        return
    limit, highest = mtf_at(number, wavelength_of(camera), lines), np.nanmax(transfer, axis=(0, 1))
    k = int(np.argmax(highest - limit))
    if highest[k] > limit[k] + 0.005:
        warn(
            f"the geometric MTF at {lines[k]:g} line pairs per mm, {highest[k]:.2f}, is above {limit[k]:.2f}, which diffraction "
            f"leaves at f/{number:.3g} and {wavelength_of(camera):g} nm (measure.diffraction_mtf): there the lens is less sharp "
            "than its rays"
        )
