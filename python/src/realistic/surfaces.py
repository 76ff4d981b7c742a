"""The surfaces of a lens, and their outlines in its cross-section."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Line = tuple[NDArray[np.float64], NDArray[np.float64]]
    """Points of a line in the cross-section: mm from the front vertex toward the film, and mm from the axis."""


class Surface(NamedTuple):
    """A surface of a lens; mm, z in lens space."""

    vertex_mm: float
    """z of the vertex; 0 for the first surface, never positive."""
    radius_mm: float
    """Radius of curvature: positive with the centre on the film's side, infinite for a plane."""
    thickness_mm: float
    """Distance to the next vertex; 0 for the last."""
    index_scene: float
    """Refractive index on the scene's side."""
    index_film: float
    """Refractive index on the film's side."""
    semi_diameter_mm: float
    """Clear semi-diameter."""
    is_stop: bool
    """Whether the surface is the aperture stop."""
    conic_radius_mm: float
    """Vertex radius of the conic; differs from `radius_mm` only if A2 adds to the curvature."""
    conic: float
    """Conic constant k: 0 for a sphere and a plane, -1 for a paraboloid."""
    aspheric: tuple[float, ...]
    """Coefficients A1, A2, ... A30, in mm^(1-i), of the sag z = c r²/(1 + √(1 - (1 + k) c² r²)) + Σ Ai r^i toward the
    film; all 0 if the surface is not aspheric."""
    radius_x_mm: float
    """Radius in the meridian x; differs from `radius_mm`, that in y, for cylinders, toroids and biconics."""
    is_mirror: bool
    """Whether the surface reflects."""
    is_turned: bool
    """Whether the surface does not share the axis of the one before it."""

    @property
    def is_round(self) -> bool:
        """Whether the surface refracts and is symmetric about the axis of the one before it."""
        return not (self.is_mirror or self.is_turned) and self.radius_x_mm == self.radius_mm


def sag(surface: Surface, height: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the sag of a surface at a height, mm from its vertex toward the film: conic plus powers of the height."""
    curvature = 1 / surface.conic_radius_mm
    root = np.sqrt(np.maximum(1 - (1 + surface.conic) * (curvature * height) ** 2, 0))
    powers = np.polynomial.polynomial.polyval(np.abs(height), [0.0, *surface.aspheric])
    found: NDArray[np.float64] = curvature * height * height / (1 + root) + powers
    return found


def outlines(surfaces: Sequence[Surface], points: int = 101) -> list[Line]:
    """Returns the surfaces in the cross-section, each from its lower to its upper edge; for the stop, its opening.

    Raises
    ------
    ValueError
        If the lens has cylinders, tilted surfaces or mirrors; `realistic draw` has their sections.
    """
    for number, surface in enumerate(surfaces):
        if not surface.is_round:
            message = f"surface {number} is a mirror, tilted or not symmetric; `realistic draw` draws such lenses"
            raise ValueError(message)
    lines = []
    for surface in surfaces:
        height = np.linspace(-1, 1, points) * min(surface.semi_diameter_mm, abs(surface.radius_mm))
        lines.append((sag(surface, height) - surface.vertex_mm, height))
    return lines


def glasses(surfaces: Sequence[Surface], points: int = 101) -> list[Line]:
    """Returns the elements in the cross-section, each as a closed line around its glass."""
    lines = outlines(surfaces, points)
    return [
        (np.concatenate([here[0], there[0][::-1]]), np.concatenate([here[1], there[1][::-1]]))
        for surface, here, there in zip(surfaces, lines, lines[1:])
        if surface.index_film > 1
    ]


def stop_blades(surfaces: Sequence[Surface]) -> list[Line]:
    """Returns the blades of the stop in the cross-section: a line below its opening, and one above."""
    outer = 1.25 * max((surface.semi_diameter_mm for surface in surfaces), default=0.0)
    return [
        (np.full(2, -surface.vertex_mm), sign * np.array([surface.semi_diameter_mm, outer]))
        for surface in surfaces
        if surface.is_stop
        for sign in (-1, 1)
    ]
