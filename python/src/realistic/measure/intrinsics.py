"""The pinhole camera with OpenCV's distortion that fits a real camera best.

From each film point of a grid, the mean ray over the pupil, weighted by light, leads to a point in a plane of the
scene. A least-squares fit finds the projection that maps these points back to the film points (the model of OpenCV's
calib3d: Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32, 1966).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .bundles import bundles_of, film_grid, in_camera_space, lens_grid, needs_pinhole, pinhole_of, plane_at, seen_from

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera


@dataclass(frozen=True, eq=False)
class Intrinsics:
    """A pinhole camera with distortion, in OpenCV's conventions.

    The centre of pixel (i, j) is at (i, j), half a pixel less than in `image_xy` of `Camera.rays`. OpenCV's camera has
    +x right, +y **down** and +z forward, and its origin is the pinhole; camera space here has +y up.

    Attributes
    ----------
    matrix : ndarray (3, 3)
        [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], pixels.
    distortion : ndarray (5,)
        k1, k2, p1, p2, k3.
    residual_rms, residual_max : float
        RMS and largest distance of the film points from their positions in the fit, pixels.
    position : ndarray (3,)
        Position of the pinhole in camera space, world units; for a lens, that of the entrance pupil.
    distance : float
        Distance from the pinhole to the plane in the scene for which the model is fitted, world units; usually
        infinite, or that of the plane in focus.
    coverage : float
        Share of the picture's film points from which a ray goes forward; the fit ignores the others.
    """

    matrix: NDArray[np.float64]
    distortion: NDArray[np.float64]
    residual_rms: float
    residual_max: float
    position: NDArray[np.float64]
    distance: float
    coverage: float

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Returns the pixels (n, 2) of points (n, 3) in OpenCV's camera axes, as `cv2.projectPoints` does."""
        points = np.asarray(points, np.float64)
        xy = points[..., :2] / points[..., 2:]
        pinhole = [self.matrix[0, 0], self.matrix[1, 1], self.matrix[0, 2], self.matrix[1, 2]]
        return _project(np.concatenate([pinhole, self.distortion]), xy)


# Indices into fx, fy, cx, cy, k1, k2, p1, p2, k3 of the parameters to fit, by number of coefficients.
_FITTED = {0: (0, 1, 2, 3), 2: (0, 1, 2, 3, 4, 5), 4: (0, 1, 2, 3, 4, 5, 6, 7), 5: (0, 1, 2, 3, 4, 5, 6, 7, 8)}


def intrinsics(camera: Camera, distance: float | None = None, *, coefficients: int = 5) -> Intrinsics:
    """Fits the pinhole matrix and OpenCV's distortion to a camera's pictures, with the residual in pixels.

    The fit uses mean rays, because a mean ray marks the centre of a blurred image, where a detector finds it.
    `Camera.export("opencv")` uses chief rays, which pass the middle of the stop. Coma and vignetting make mean rays
    and chief rays differ.

    Parameters
    ----------
    distance : float, optional
        Distance of the plane in the scene for which to fit, given like `focus_distance`: world units from the film
        plane (for model "perspective" from the eye), or inf. Default: the plane in focus.
    coefficients : int
        Number of distortion coefficients: 5 (k1, k2, p1, p2, k3), 4, 2 or 0. The others are 0.

    Returns
    -------
    Intrinsics
        The fit, in the conventions of OpenCV that `Intrinsics` states.

    Raises
    ------
    ValueError
        For model "orthographic" or "environment"; for a plane behind the pinhole; if the camera sees nearly nothing.

    Notes
    -----
    The fit uses up to 1,089 film points from edge to edge, with 256 rays each and the camera's weights. No polynomial
    of OpenCV fits a fisheye: see `residual_max`, and `coverage` for film points that see sideways or nothing.
    """
    needs_pinhole(camera)
    if coefficients not in _FITTED:
        raise ValueError(f"coefficients is {coefficients}; give 0, 2 (k1, k2), 4 (and p1, p2) or 5 (and k3)")
    with in_camera_space(camera) as plain:
        image_xy = film_grid(camera.resolution, 33)
        bundles = bundles_of(plain, image_xy, lens_grid(16))
        plane = plane_at(plain, distance)
    seen = bundles.has_light
    if np.count_nonzero(seen) < 8:
        raise ValueError("too few film points see anything forward of the camera for a fit")
    pinhole = pinhole_of(bundles)
    xy = seen_from(bundles, pinhole, plane)[seen] * [1.0, -1.0]
    pixels = image_xy[seen] - 0.5

    numbers = _least_squares(xy, pixels, np.array(_FITTED[coefficients]))
    off = np.hypot(*(_project(numbers, xy) - pixels).T)
    fx, fy, cx, cy = numbers[:4]
    return Intrinsics(
        matrix=np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]),
        distortion=numbers[4:],
        residual_rms=float(np.sqrt(np.mean(off**2))),
        residual_max=float(off.max()),
        position=np.array([0.0, 0.0, pinhole]),
        distance=plane - pinhole,
        coverage=float(np.mean(seen)),
    )


def _project(numbers: NDArray[np.float64], xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the pixels of points in the plane z = 1; `numbers` are fx, fy, cx, cy, k1, k2, p1, p2, k3."""
    fx, fy, cx, cy, k1, k2, p1, p2, k3 = numbers
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.stack([fx * u + cx, fy * v + cy], axis=-1)


def _slopes(numbers: NDArray[np.float64], xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the derivatives of `_project` with respect to its nine numbers, (2n, 9): first those of u, then those of
    v."""
    fx, fy, _, _, k1, k2, p1, p2, k3 = numbers
    x, y = xy[:, 0], xy[:, 1]
    r2 = x * x + y * y
    zero, one = np.zeros_like(x), np.ones_like(x)
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    xr, yr = fx * x * r2, fy * y * r2
    of_u = [u, zero, one, zero, xr, xr * r2, fx * 2 * x * y, fx * (r2 + 2 * x * x), xr * r2 * r2]
    of_v = [zero, v, zero, one, yr, yr * r2, fy * (r2 + 2 * y * y), fy * 2 * x * y, yr * r2 * r2]
    return np.concatenate([np.stack(of_u, axis=1), np.stack(of_v, axis=1)])


def _least_squares(
    xy: NDArray[np.float64], pixels: NDArray[np.float64], fitted: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Fits by Gauss-Newton iteration, and halves each step until it reduces the error; begins without distortion."""

    def residual(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        return (pixels - _project(numbers, xy)).T.ravel()

    numbers = np.zeros(9)
    for k in range(2):
        columns = np.stack([xy[:, k], np.ones(len(xy))], axis=1)
        numbers[k], numbers[2 + k] = np.linalg.lstsq(columns, pixels[:, k], rcond=None)[0]
    left = residual(numbers)
    for _ in range(100):
        jacobian = _slopes(numbers, xy)[:, fitted]
        # Columns differ by orders of magnitude, such as r^7 and 1.
        scale = np.linalg.norm(jacobian, axis=0)
        step = np.zeros(9)
        step[fitted] = np.linalg.lstsq(jacobian / scale, left, rcond=None)[0] / scale
        for _ in range(40):
            trial = residual(numbers + step)
            if trial @ trial < left @ left:
                break
            step /= 2
        else:
            return numbers
        gain = 1 - (trial @ trial) / (left @ left)
        numbers, left = numbers + step, trial
        if gain < 1e-12:
            return numbers
    return numbers
