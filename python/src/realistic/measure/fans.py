"""Ray fans and field curvature, from exact rays that are traced from object points through the lens alone.

The object point of a film point is the point where the mean of its rays meets a plane of the scene. From there, rays
are traced back through the unvignetted pupil (W. J. Smith, *Modern Optical Engineering*, 4th edition, 2008, chapter 3).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..parameters import focuses_by_film, mm_per_unit_of
from .bundles import Bundles, bundles_of, in_camera_space, lens_grid, lens_of, plane_at
from .points import film_points

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..camera import Camera
    from ..lens import Lens
    from .points import FieldLike


@dataclass(frozen=True, eq=False)
class Fans:
    """Transverse ray aberrations: distances on the film from the object point's ray that passes the middle of the
    pupil.

    The tangential direction is along the line from the picture's middle to the film point, outward positive; the
    sagittal direction is perpendicular to it. For a film point in the middle, outward means upward.

    Attributes
    ----------
    pupil : ndarray (k,)
        Pupil coordinate from -1 to 1, edge to edge of the film point's unvignetted pupil.
    tangential : ndarray (n, k)
        Tangential distance on the film, mm, of rays through the pupil along the tangential line; NaN for a blocked ray.
    sagittal : ndarray (n, k)
        Sagittal distance on the film, mm, of rays along the sagittal line; NaN for a blocked ray.
    """

    pupil: NDArray[np.float64]
    tangential: NDArray[np.float64]
    sagittal: NDArray[np.float64]


def fans(camera: Camera, field: FieldLike, *, distance: float | None = None, rays: int = 101) -> Fans:
    """Returns the ray fans of the object points that are imaged to some film points.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        Distance of the plane in the scene, given like `focus_distance`; default the plane in focus.
    rays : int
        Number of rays in each fan; odd, so that one passes through the middle.

    Raises
    ------
    ValueError
        For a camera without surfaces to trace: `model` other than "lens", or `focus_by` "group".
    """
    if rays < 3 or rays % 2 == 0:
        raise ValueError(f"a fan has an odd number of rays, 3 or more, not {rays}")
    pupil = np.linspace(-1, 1, rays)
    image_xy, shape = film_points(camera, field, distance)
    points = _ObjectPoints(camera, image_xy, distance)
    fan = []
    for axis in range(2):
        at = points.film(axis, pupil)[0][..., axis]
        # If the pupil's edge is not round, the middle ray may be blocked; then the whole fan is NaN.
        fan.append((at - at[:, rays // 2, None]).reshape(*shape, rays))
    return Fans(pupil, fan[0], fan[1])


def field_curvature(camera: Camera, field: FieldLike, *, distance: float | None = None) -> NDArray[np.float64]:
    """Returns the distances behind the film at which narrow bundles through the middle of the pupil are in focus.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        Distance of the plane in the scene, given like `focus_distance`; default the plane in focus.

    Returns
    -------
    ndarray (n, 2)
        Tangential and sagittal focus, mm along the axis, positive behind the film; NaN where there is no light.

    Raises
    ------
    ValueError
        As `fans`.
    """
    image_xy, shape = film_points(camera, field, distance)
    points = _ObjectPoints(camera, image_xy, distance)
    focus = []
    for axis in range(2):
        # At a hundredth of the pupil's radius, higher-order aberrations are a ten-thousandth of those at the pupil's
        # edge.
        at, slope = points.film(axis, np.array([-0.01, 0.01]))
        apart, spread = (np.diff(numbers[..., axis], axis=1)[:, 0] for numbers in (at, slope))
        focus.append(-apart / spread)
    return np.stack(focus, axis=-1).reshape(*shape, 2)


class _ObjectPoints:
    """Object points in lens space (mm, +z toward the scene), and the unvignetted parts of their pupils."""

    def __init__(self, camera: Camera, image_xy: NDArray[np.float64], distance: float | None) -> None:
        if not focuses_by_film(camera.parameters):
            raise ValueError('there are no surfaces to trace: the camera\'s model must be "lens", and focus_by "film"')
        self.lens: Lens = lens_of(camera)
        mm = mm_per_unit_of(camera.parameters)
        with in_camera_space(camera) as plain:
            plane = plane_at(plain, distance)
            bundles: Bundles = bundles_of(plain, image_xy, lens_grid(32))
            to_the_edge: Bundles = bundles_of(plain, image_xy, _lens_grid_to_the_edge(64))
        self.film_z = self.lens.rear_vertex_mm - camera.film_distance
        # The picture is the film's image turned upright: what is right of the axis in the scene is on the right of the
        # picture.
        radial = (image_xy - np.array(camera.resolution) / 2) * [1, -1]
        length = np.hypot(*radial.T)[:, None]
        outward = np.where(length > 0, radial / np.maximum(length, 1e-300), [0.0, 1.0])
        self.axes = np.stack([outward, np.stack([-outward[:, 1], outward[:, 0]], axis=-1)], axis=1)
        # The middle of the unvignetted pupil in the plane of the front vertex, and half its width along both axes.
        lit = to_the_edge.weight > 0
        along = np.einsum("nmk,nak->nam", to_the_edge.at * mm, self.axes)
        low, high = (
            bound(np.where(lit[:, None, :], along, none), axis=2)
            for bound, none in ((np.min, np.inf), (np.max, -np.inf))
        )
        low, high = (np.where(lit.any(axis=1, keepdims=True), bound, np.nan) for bound in (low, high))
        self.half = (high - low) / 2
        self.middle = np.einsum("na,nak->nk", (high + low) / 2, self.axes)
        mean = bundles.mean(bundles.points(plane))
        self.slope = mean if np.isinf(plane) else None
        self.point = np.column_stack([mean * mm, np.full(len(mean), plane * mm)])
        self.before = 10 + 2 * max(surface.semi_diameter_mm for surface in self.lens.surfaces)

    def film(self, axis: int, pupil: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the points where rays at pupil coordinates along an axis meet the film, and the rays' slopes there.

        Both are (n, k, 2): tangential and sagittal, outward positive in the picture; slopes are per mm behind the film.
        """
        n, k = len(self.middle), len(pupil)
        through = self.middle[:, None] + (self.half[:, axis, None] * pupil)[..., None] * self.axes[:, axis, None]
        through = np.concatenate([through, np.zeros((n, k, 1))], axis=-1)
        if self.slope is None:
            origin = np.broadcast_to(self.point[:, None], (n, k, 3))
            direction = through - origin
        else:
            toward = -np.column_stack([self.slope, np.ones(n)])
            direction = np.broadcast_to(toward[:, None], (n, k, 3))
            origin = through - direction * self.before
        rays = self.lens.trace(np.nan_to_num(origin), np.where(np.isnan(direction), [0.0, 0.0, -1.0], direction))
        dz = rays.direction[..., 2:]
        slope = rays.direction[..., :2] / -dz
        at = rays.origin[..., :2] + slope * (rays.origin[..., 2:] - self.film_z)
        passed = rays.passed & np.isfinite(origin).all(axis=-1)
        # The film's image is upside down: right and up in the picture are left and down on the film.
        return tuple(
            np.where(passed[..., None], -np.einsum("nmk,nak->nma", numbers, self.axes), np.nan)
            for numbers in (at, slope)
        )  # type: ignore[return-value]


def _lens_grid_to_the_edge(side: int) -> NDArray[np.float32]:
    """Returns `side` times `side` lens samples; the outermost lie just inside the pupil's edge, where rays pass."""
    edge = 1 / 512
    u, v = np.meshgrid(*[np.linspace(edge, 1 - edge, side, dtype=np.float32)] * 2)
    return np.stack([u.ravel(), v.ravel()]).T
