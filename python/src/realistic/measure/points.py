"""Field points: the points of the picture at which measures, plots and studies are computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from .bundles import bundles_of, in_camera_space, lens_grid, pinhole, plane_at, seen_from

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera

    FieldLike: TypeAlias = "Field | ArrayLike"
    """Field argument of measures: a `Field`, or pixels as for `Field.pixels`."""


@dataclass(frozen=True, eq=False, repr=False)
class Field:
    """Points of the picture: in pixels, as fractions of the picture, or as field angles.

    Make a field by `Field.pixels`, `Field.fractions`, `Field.grid` or `Field.angles`. Measures return results in the shape of the
    points; for one point, a single result.

    Attributes
    ----------
    unit : "pixels", "fractions" or "angles"
        Unit of the coordinates.
    x, y : ndarray
        Coordinates of the points; without `y`, `x` is along the diagonal toward the upper right corner.

    Examples
    --------
    >>> import realistic
    >>> from realistic import measure
    >>> camera = realistic.Camera("dgauss.50mm", resolution=(1500, 1000))
    >>> measure.Field.fractions([0, 0.5, 1]).image_xy(camera).tolist()
    [[750.0, 500.0], [1125.0, 250.0], [1500.0, 0.0]]
    >>> measure.field_angle(camera, measure.Field.angles([0, 10])).round(4).tolist()
    [0.0, 10.0]
    """

    unit: Literal["pixels", "fractions", "angles"]
    x: NDArray[np.float64]
    y: NDArray[np.float64] | None = None

    @classmethod
    def pixels(cls, image_xy: ArrayLike) -> Field:
        """Makes a field of raster positions (..., 2), as for `Camera.rays`: (0, 0) is the upper left corner."""
        points = np.asarray(image_xy, np.float64)
        if points.ndim == 0 or points.shape[-1] != 2:
            raise ValueError(
                f"field points in pixels have shape (n, 2), or (2,) for one, and not {points.shape}; "
                "Field.fractions and Field.angles take single numbers"
            )
        return cls("pixels", _finite(points[..., 0]), _finite(points[..., 1]))

    @classmethod
    def fractions(cls, diagonal: ArrayLike | None = None, *, x: ArrayLike = 0.0, y: ArrayLike = 0.0) -> Field:
        """Makes a field of fractions of the picture: 0 is its middle, 1 its edge.

        Give either fractions of half the diagonal, toward the upper right corner; or `x`, fractions of half the width
        to the right, and `y`, fractions of half the height up, from -1 to 1.
        """
        field = cls("fractions", *_along_or_across(diagonal, x, y))
        for numbers in (field.x, field.y):
            if numbers is not None and (np.abs(numbers) > 1).any():
                raise ValueError(f"fractions of the picture are from -1 to 1, and not {numbers.tolist()}")
        return field

    @classmethod
    def grid(cls, columns: int, rows: int) -> Field:
        """Makes a field of the middles of `columns` times `rows` equal parts of the picture, (rows, columns): from the
        left, and from the top.

        Maps over the picture have such a field.
        """
        if min(columns, rows) < 1:
            raise ValueError(f"a grid has a column and a row at least, and not {columns} x {rows}")
        x, y = ((2 * np.arange(count) + 1) / count - 1 for count in (columns, rows))
        return cls("fractions", *np.meshgrid(x, -y))

    @classmethod
    def angles(cls, diagonal: ArrayLike | None = None, *, x: ArrayLike = 0.0, y: ArrayLike = 0.0) -> Field:
        """Makes a field of angles in degrees between the axis and the direction in which the camera sees a point.

        Give either angles of points on the diagonal, toward the upper right corner; or `x` to the right and `y` up, for
        the direction (tan x, tan y, 1). The angles are those of lines from the entrance pupil to points of the plane in
        focus, or of the plane of the measure.
        """
        field = cls("angles", *_along_or_across(diagonal, x, y))
        for numbers in (field.x, field.y):
            if numbers is not None and (np.abs(numbers) >= 90).any():
                raise ValueError(f"field angles are less than 90 degrees, and not {numbers.tolist()}")
        return field

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the points; () for one point."""
        return self.x.shape

    def image_xy(self, camera: Camera, distance: float | None = None) -> NDArray[np.float64]:
        """Returns the points as raster positions, (..., 2); NaN for a field angle outside the picture.

        `distance` is that of the plane to which field angles refer, given like `focus_distance`; default the plane in
        focus.
        """
        half = np.array(camera.resolution) / 2
        if self.unit != "angles":
            return self._raster(half)
        if self.y is None:
            direction = np.broadcast_to(half / np.hypot(*half) * [1.0, -1.0], (*self.shape, 2)) * _sign(self.x)
            tangent = np.tan(np.radians(np.abs(self.x)))
        else:
            across = np.tan(np.radians(np.stack([self.x, -self.y], axis=-1)))
            tangent = np.hypot(across[..., 0], across[..., 1])
            direction = across / np.maximum(tangent, 1e-300)[..., None]
        flat = direction.reshape(-1, 2)
        return half + (direction.T * _radii(camera, flat, tangent.ravel(), distance).reshape(self.shape).T).T

    def _raster(self, half: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the raster positions of pixels and fractions, in a picture of width and height 2 * `half`."""
        up = self.x if self.y is None else self.y
        if self.unit == "pixels":
            return np.stack([self.x, up], axis=-1)
        return half + np.stack([self.x, -up], axis=-1) * half

    def share(self, resolution: tuple[int, int]) -> NDArray[np.float64]:
        """Returns the points' distances from the middle over half the diagonal; NaN for angles, which need a camera."""
        if self.unit == "angles":
            return np.full(self.shape, np.nan)
        if self.unit == "fractions" and self.y is None:
            return self.x
        half = np.array(resolution) / 2
        away = self._raster(half) - half
        return np.asarray(np.hypot(away[..., 0], away[..., 1]) / np.hypot(*half))

    def angle(self) -> NDArray[np.float64]:
        """Returns the field angles of points given as angles, degrees; NaN for others: see `field_angle`."""
        if self.unit != "angles":
            return np.full(self.shape, np.nan)
        if self.y is None:
            return self.x
        x, y = (np.tan(np.radians(numbers)) for numbers in (self.x, self.y))
        return np.asarray(np.degrees(np.arctan(np.hypot(x, y))))

    @property
    def labels(self) -> list[str]:
        """Short text for each point, such as "0.5" or "10°"."""
        sign = "°" if self.unit == "angles" else ""
        if self.y is None:
            return [f"{x:g}{sign}" for x in self.x.flat]
        return [f"({x:g}{sign}, {y:g}{sign})" for x, y in zip(self.x.flat, self.y.flat)]

    def __repr__(self) -> str:
        return (
            f"<Field of {self.x.size} points, {self.unit}: {', '.join(self.labels[:8])}{', ...' * (self.x.size > 8)}>"
        )


def film_points(
    camera: Camera, field: FieldLike, distance: float | None
) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Returns the raster positions (n, 2) of field points, and the shape of the given points.

    Raises
    ------
    ValueError
        For a field angle outside the picture.
    """
    points = field if isinstance(field, Field) else Field.pixels(field)
    image_xy = points.image_xy(camera, distance).reshape(-1, 2)
    beyond = np.isnan(image_xy).any(axis=-1)
    if beyond.any():
        corner = float(field_angle(camera, Field.fractions(1.0), distance=distance))
        end = "is dark" if np.isnan(corner) else f"is at {corner:.3g}°"
        raise ValueError(f"the picture does not reach to {points.labels[int(beyond.argmax())]}: its corner {end}")
    return image_xy, points.shape


def field_angle(camera: Camera, field: FieldLike, *, distance: float | None = None) -> NDArray[np.float64]:
    """Returns the angle between the axis and the direction in which the camera sees points of the picture.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        Distance of the plane in the scene, given like `focus_distance`; default the plane in focus. Angles are measured
        at the entrance pupil.

    Returns
    -------
    ndarray (n,)
        Degrees; NaN where there is no light, and where some light comes from the side or from behind.
    """
    image_xy, shape = film_points(camera, field, distance)
    with in_camera_space(camera) as plain:
        plane = plane_at(plain, distance)
        found = _tangents(plain, image_xy, pinhole(plain, plane), plane)
    return np.degrees(np.arctan(found)).reshape(shape)


def _tangents(plain: Camera, image_xy: NDArray[np.float64], z: float, plane: float) -> NDArray[np.float64]:
    """Returns the tangents of field angles, (n,), from a pinhole at z to points of a plane."""
    seen = seen_from(bundles_of(plain, image_xy, lens_grid(16)), z, plane)
    tangents: NDArray[np.float64] = np.hypot(seen[:, 0], seen[:, 1])
    return tangents


def _radii(
    camera: Camera, direction: NDArray[np.float64], tangent: NDArray[np.float64], distance: float | None
) -> NDArray[np.float64]:
    """Returns the radii, pixels from the middle, at which directions (n, 2) have given field angles; NaN outside the
    picture.

    The angle grows with the radius. So each round evaluates 17 radii in an interval and keeps the two that enclose the
    angle.
    """
    half = np.array(camera.resolution) / 2
    n, last = len(direction), 16
    steps = np.linspace(0, 1, last + 1)
    low = np.zeros(n)
    # The first interval reaches to the picture's edge.
    high = np.min(half / np.maximum(np.abs(direction), 1e-300), axis=1)
    with in_camera_space(camera) as plain:
        plane = plane_at(plain, distance)
        z = pinhole(plain, plane)
        for _ in range(5):
            radii = low[:, None] + (high - low)[:, None] * steps
            points = half + radii[..., None] * direction[:, None, :]
            found = _tangents(plain, points.reshape(-1, 2), z, plane).reshape(n, last + 1)
            # A point that sees nothing forward counts as infinitely far out.
            beyond = np.where(np.isnan(found), np.inf, found) >= tangent[:, None] * (1 - 1e-12)
            at = np.where(beyond.any(axis=1), beyond.argmax(axis=1), last + 1)
            upper, lower = np.clip(at, 1, last), np.clip(at, 1, last) - 1
            rows = np.arange(n)
            low, high = radii[rows, lower], radii[rows, upper]
            between = found[rows, lower], found[rows, upper]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = (tangent - between[0]) / (between[1] - between[0])
    radius = np.where(tangent > 0, low + (high - low) * np.clip(share, 0, 1), 0.0)
    return np.where((at > last) | np.isnan(radius), np.nan, radius)


def _along_or_across(
    diagonal: ArrayLike | None, x: ArrayLike, y: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    across, up = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    if diagonal is None:
        return _finite(across), _finite(up)
    if across.any() or up.any():
        raise TypeError("give field points along the diagonal, or x and y, and not both")
    return _finite(np.asarray(diagonal, np.float64)), None


def _finite(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    if not np.isfinite(numbers).all():
        raise ValueError(f"a field point is not a finite number: {numbers.tolist()}")
    return numbers


def _sign(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(numbers < 0, -1.0, 1.0)[..., None]
