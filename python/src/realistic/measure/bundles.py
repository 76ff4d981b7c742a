"""Bundles: the rays from film points through the whole pupil, in camera space.

Every fit and measure of a camera gets its rays here. A ray is stored as the line x(z) = at + slope * z.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import quietly
from ..lens import Lens
from ..parameters import mm_per_unit_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from ..camera import Camera

_NOT_THE_LENS = (
    "camera_to_world",
    "camera_to_world_end",
    "transform_start",
    "transform_end",
    "shutter",
    "shutter_ramp",
    "shutter_slit",
    "disk",
)


@dataclass(eq=False)
class Bundles:
    """The rays of `m` lens samples from each of `n` film points.

    Attributes
    ----------
    at : ndarray (n, m, 2)
        Point where a ray's line meets the plane z = 0 of camera space, world units.
    slope : ndarray (n, m, 2)
        dx/dz and dy/dz of the line.
    weight : ndarray (n, m)
        Weight of the ray; 0 if it is blocked or does not travel forward.
    """

    at: NDArray[np.float64]
    slope: NDArray[np.float64]
    weight: NDArray[np.float64]

    @property
    def has_light(self) -> NDArray[np.bool_]:
        """Mask of the film points from which some ray leaves the lens, (n,)."""
        light: NDArray[np.bool_] = self.weight.sum(axis=1) > 0
        return light

    def mean(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the weighted mean, (n, 2), of values (n, m, 2) over the lens samples; NaN without light."""
        weight = self.weight[..., None]
        with np.errstate(invalid="ignore"):
            mean: NDArray[np.float64] = (values * weight).sum(axis=1) / weight.sum(axis=1)
        return mean

    def points(self, z: float) -> NDArray[np.float64]:
        """Returns the points where the rays meet the plane z, or their slopes if z is infinite, (n, m, 2)."""
        return self.slope if np.isinf(z) else self.at + self.slope * z


@contextmanager
def in_camera_space(camera: Camera) -> Iterator[Camera]:
    """Provides the camera at rest at the origin, with an open shutter and the default map from lens samples to a disk.
    Builds a new camera only if it would differ from the given one."""
    plain: dict[str, Any] = {name: None for name in _NOT_THE_LENS if name in camera._arguments()}
    if not plain:
        yield camera
        return
    with quietly():
        built = camera.replace(**plain)
    with built:
        yield built


def lens_grid(side: int) -> NDArray[np.float32]:
    """Returns lens samples at the centres of `side` times `side` cells, (side², 2)."""
    middles = (np.arange(side, dtype=np.float32) + np.float32(0.5)) / np.float32(side)
    u, v = np.meshgrid(middles, middles)
    return np.stack([u.ravel(), v.ravel()]).T


def pupil_rule(
    plain: Camera, image_xy: NDArray[np.float64], side: int
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Returns lens samples for integrals over the pupils of film points, (n, side², 2), and the share of the unit
    square that each sample represents, (n, side²); `side` must be even.

    The samples are Gauss-Legendre nodes along equally spaced radii, each up to the edge of the lit pupil. Over a smooth
    pupil, the error falls exponentially with the number of nodes, whereas the error of a grid falls only with the
    square of that number (G. W. Forbes, "Optical system assessment for design: numerical ray tracing in the Gaussian
    pupil", J. Opt. Soc. Am. A 5, 1988).
    """
    nodes, weights = np.polynomial.legendre.leggauss(side // 2)
    nodes = (nodes + 1) / 2
    arms = 2 * side
    # The concentric map turns squares into circles, and equal parts of a square's side into equal angles.
    quarter, along = np.divmod((np.arange(arms) + 0.5) * 4 / arms, 1.0)
    turn = np.exp(0.5j * np.pi * quarter) * (1 + 1j * (2 * along - 1))
    ends = np.stack([turn.real, turn.imag], axis=-1)

    def samples(radius: NDArray[np.float64]) -> NDArray[np.float32]:
        """Returns the lens samples, (n, arms * k, 2), at radii (n, arms, k)."""
        uv = 0.5 + 0.5 * radius[..., None] * ends[:, None, :]
        return uv.reshape(len(radius), -1, 2).astype(np.float32)

    def passes(radius: NDArray[np.float64]) -> NDArray[np.bool_]:
        rays = plain.rays(image_xy[:, None, :], samples(radius[..., None]))
        return np.asarray(rays.weight > 0)

    low, high = np.zeros((len(image_xy), arms)), np.ones((len(image_xy), arms))
    # The whole radius is used if the ray through the middle of the pupil is blocked, or the one at the radius's end
    # passes.
    whole = ~passes(low) | passes(high)
    for _ in range(14):
        middle = (low + high) / 2
        inside = passes(middle)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    edge = np.where(whole, 1.0, low)[..., None]
    share = edge**2 * (nodes * weights / arms)
    return samples(edge * nodes), share.reshape(len(image_xy), -1)


def film_grid(resolution: tuple[int, int], most: int) -> NDArray[np.float64]:
    """Returns a grid of film points from edge to edge of the picture, at most `most` along the longer side, (n, 2)."""
    longer = max(resolution)
    x, y = (np.linspace(0, size, max(2, round(most * size / longer))) for size in resolution)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def bundles_of(plain: Camera, image_xy: NDArray[np.float64], lens_uv: NDArray[np.float32]) -> Bundles:
    """Returns the bundles of film points (n, 2) or (n, m, 2), with lens samples (m, 2) for all or (n, m, 2)."""
    rays = plain.rays(image_xy[:, None, :] if image_xy.ndim == 2 else image_xy, lens_uv)
    origin, direction = rays.origin.astype(np.float64), rays.direction.astype(np.float64)
    forward = (rays.weight > 0) & (direction[..., 2] > 0)
    # If a ray of a film point goes sideways or backward, the film point has no mean ray that meets a plane.
    forward &= ~np.any((rays.weight > 0) & (direction[..., 2] <= 0), axis=1, keepdims=True)
    dz = np.where(forward, direction[..., 2], 1.0)[..., None]
    slope = np.where(forward[..., None], direction[..., :2] / dz, 0.0)
    at = np.where(forward[..., None], origin[..., :2] - slope * origin[..., 2:], 0.0)
    return Bundles(at, slope, np.where(forward, rays.weight, 0.0).astype(np.float64))


def plane_at(plain: Camera, distance: float | None) -> float:
    """Returns z in camera space of a plane in the scene, for a distance like `focus_distance`; None means the plane in
    focus.

    Raises
    ------
    ValueError
        For a distance that is not positive.
    """
    if distance is None:
        return plane_in_focus(plain)
    if not distance > 0:
        raise ValueError(f"distance is {distance}; it must be positive, in world units")
    return distance + film_plane(plain) if plain.interfaces > 0 and np.isfinite(distance) else float(distance)


def needs_pinhole(camera: Camera) -> None:
    """Raises a ValueError for a camera without a projection centre."""
    model = camera.parameters.get("model", "lens")
    if model in ("orthographic", "environment"):
        raise ValueError(
            f'model "{model}" has no pinhole; intrinsics, field angles and distortion are those of a lens or a perspective'
        )


def pinhole(plain: Camera, plane: float) -> float:
    """Returns z of the pinhole from which a camera of `in_camera_space` sees a plane; for a lens, the entrance
    pupil."""
    needs_pinhole(plain)
    if np.isinf(plane):
        # Directions to a plane at infinity do not depend on the pinhole.
        return 0.0
    return pinhole_of(bundles_of(plain, film_grid(plain.resolution, 17), lens_grid(16)))


def pinhole_of(bundles: Bundles) -> float:
    """Returns z of the point on the axis nearest to the mean rays of film points, in the least squares sense."""
    at, slope = bundles.mean(bundles.at), bundles.mean(bundles.slope)
    seen = bundles.has_light
    return -float((at * slope)[seen].sum() / (slope * slope)[seen].sum())


def seen_from(bundles: Bundles, z: float, plane: float) -> NDArray[np.float64]:
    """Returns the point where the mean ray of each film point meets the plane, as its direction (dx/dz, dy/dz) from the
    pinhole at z, (n, 2).

    Raises
    ------
    ValueError
        For a plane that is not in front of the pinhole.
    """
    if np.isinf(plane):
        return bundles.mean(bundles.slope)
    if plane <= z:
        raise ValueError(f"the plane to be seen lies {z - plane:g} behind the pinhole; give a greater distance")
    return bundles.mean(bundles.points(plane)) / (plane - z)


def film_plane(plain: Camera) -> float:
    """Returns z of the film plane (negative) in camera space, world units, for a camera of `in_camera_space` with a
    lens."""
    return (lens_of(plain).rear_vertex_mm - plain.film_distance) / mm_per_unit_of(plain.parameters)


def lens_of(camera: Camera) -> Lens:
    """Returns the lens of a camera, without the film."""
    given = camera.parameters
    names = ("lens_file", "lens_text", "glass_catalog", "zoom", "wavelength", "aperture_diameter", "fnumber")
    with quietly():
        return Lens(**{name: given[name] for name in names if name in given})


def plane_in_focus(plain: Camera) -> float:
    """Returns z of the plane in focus in camera space, world units; infinite for focus at infinity and for a
    pinhole."""
    if plain.interfaces > 0:
        focus = plain.focus_distance_mm
        if not np.isfinite(focus):
            return float("inf")
        return film_plane(plain) + focus / mm_per_unit_of(plain.parameters)
    if plain.parameters.get("lens_radius", 0.0) > 0:
        return float(plain.parameters.get("focal_distance", np.inf))
    return float("inf")
