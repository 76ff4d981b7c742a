"""Ghosts of a lens: the report of `realistic flare`, as objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ._program import report


@dataclass(frozen=True)
class Ghost:
    """A ghost: a lamp's light that is reflected by two surfaces on its way to the film."""

    surfaces: tuple[int, int]
    """Indices of the two surfaces, counted from 0 at the scene side, in the order (second reflection, first
    reflection)."""
    watts: float
    """Power that reaches the film plane, W, if the lamp's irradiance at the lens is 1 W/m² on a plane perpendicular to
    its light."""
    middle_mm: tuple[float, float]
    """Centroid of the ghost on the film plane, x and y."""
    rms_radius_mm: float
    """Root mean square distance from the centroid."""
    focus_before_film_mm: float | None
    """Distance of the ghost's focus in front of the film (toward the scene), for a lamp at infinity on the axis; None
    if the ghost has no focus."""


def ghosts(parameters: Mapping[str, Any], light: Sequence[float], coating: str) -> tuple[Ghost, ...]:
    """Returns the ghosts that `realistic flare --json` reports for a lens, the brightest first."""
    at = ",".join(repr(float(number)) for number in light)
    found = report(["flare", f"--light={at}", f"--coating={coating}"], parameters)
    return tuple(_ghost(pair) for pair in found["pairs"])


def _ghost(pair: Mapping[str, Any]) -> Ghost:
    first, second = pair["surfaces"]
    x, y = pair["middle_mm"]
    return Ghost(
        surfaces=(first - 1, second - 1),
        watts=pair["watts"],
        middle_mm=(x, y),
        rms_radius_mm=pair["rms_radius_mm"],
        focus_before_film_mm=pair["focus_before_film_mm"],
    )
