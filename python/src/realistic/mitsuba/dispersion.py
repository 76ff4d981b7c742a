"""Chooses the wavelengths that share one ray through a lens with dispersion.

A path of Mitsuba has four wavelengths and one ray. A ray is traced at each of the four. Two wavelengths go together if
their rays meet the plane in focus at points less than a tolerance apart, measured in pixels on that plane. One of the
four, the hero (A. Wilkie et al., "Hero Wavelength Spectral Sampling", 2014), gives the path its ray, and the path
carries the wavelengths that go together with the hero. Let q_h be the probability of hero h, and A_hk 1 if h and k go
together (k goes with itself), else 0. Wavelength k then has the factor

    A_hk / sum over h' of q_h' A_h'k,

the balance heuristic: its mean over the heroes is 1 for all q and A. The probabilities affect only the noise. Here q_h
is proportional to the amount that a path of hero h would carry in the film's channels if all heroes were equally
probable. This choice gives the least variance if the wavelengths fall into groups.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

WAVELENGTHS = (380.0, 780.0)
"""Range of wavelengths of rays, nm; Mitsuba's range is a little wider, where eyes see nothing."""

# The least probability of a hero, relative to the most probable one: it bounds the weight of wavelengths that only this
# hero carries.
_LEAST = 0.02

# Weights of the squares of X, Y and Z in the amount that a path carries. A larger weight of Y lowers the noise of
# luminance and raises the noise of colour. Even without dispersion, the noise of colour is the higher one.
_CHANNELS = (1.0, 20.0, 1.0)

# Number of equal steps of the random number from which the wavelengths are sampled; the position within a step chooses
# the hero. Within a step, the wavelengths change by one or two nanometres, and 15 of the number's 23 bits remain for
# the choice.
_STEPS = 256.0


def amounts(spectral: bool, wavelengths: Any, response: Any) -> list[list[Any]]:
    """Returns each wavelength's contribution to each film channel, up to a constant factor; for spectral film, the
    response at each wavelength."""
    if spectral:
        return [[response[k]] for k in range(len(wavelengths))]
    found = []
    for k in range(len(wavelengths)):
        xyz = mi.cie1931_xyz(wavelengths[k])
        found.append([scale**0.5 * response[k] * xyz[channel] for channel, scale in enumerate(_CHANNELS)])
    return found


def landing(point: Callable[[Any], Any], rays: Sequence[Any], right: Any, down: Any) -> tuple[list[Any], Any]:
    """Returns where rays (7 columns each) land relative to the first, pixels (x, y), and whether that is known.

    `point` returns the point that represents a ray; `right` and `down` are the first ray's neighbours, one pixel away.
    """
    first = point(rays[0])
    x, y = point(right) - first, point(down) - first
    xx, xy, yy = dr.dot(x, x), dr.dot(x, y), dr.dot(y, y)
    determinant = xx * yy - xy * xy
    known = (rays[0][6] > 0) & (right[6] > 0) & (down[6] > 0) & (determinant > 0)
    scale = 1 / dr.select(known, determinant, 1)
    found = []
    for ray in rays:
        step = point(ray) - first
        along, across = dr.dot(step, x), dr.dot(step, y)
        found.append((scale * (yy * along - xy * across), scale * (xx * across - xy * along)))
    return found, known


def carried(
    weights: Sequence[Any],
    positions: Sequence[Any],
    known: Any,
    each: Sequence[Sequence[Any]],
    number: Any,
    tolerance: float,
) -> tuple[list[Any], list[Any]]:
    """Chooses the hero of a path; returns a mask for each wavelength, true for the hero alone, and each wavelength's
    factor, which is 0 if the wavelength is not carried.

    Parameters
    ----------
    weights : weights of the rays; 0 for a blocked ray, which goes together with no other.
    positions, known : as from `landing`; where they are unknown, no two wavelengths go together.
    each : as from `amounts`.
    number : the random number in [0, 1) from which the wavelengths were sampled.
    tolerance : pixels; at 0 each wavelength goes alone.
    """
    every = range(len(weights))
    passes = [weight > 0 for weight in weights]
    together: dict[tuple[int, int], Any] = {}
    for h in every:
        together[h, h] = dr.select(passes[h], 1.0, 0.0)
        for k in range(h):
            apart = dr.square(positions[h][0] - positions[k][0]) + dr.square(positions[h][1] - positions[k][1])
            joined = known & passes[h] & passes[k] & (apart < tolerance * tolerance)
            together[h, k] = together[k, h] = dr.select(joined, 1.0, 0.0)

    def counts(probability: Sequence[Any], k: int) -> Any:
        """Returns the inverse of the probability that wavelength k is carried."""
        total = sum(probability[h] * together[h, k] for h in every)
        return dr.select(total > 0, 1 / dr.select(total > 0, total, 1), 0.0)

    even = [counts([1.0] * len(weights), k) * weights[k] for k in every]
    sizes = []
    for h in every:
        parts = [sum(together[h, k] * even[k] * each[k][channel] for k in every) for channel in range(len(each[0]))]
        sizes.append(dr.sqrt(sum(dr.square(part) for part in parts)))
    most = dr.maximum(dr.maximum(sizes[0], sizes[1]), dr.maximum(sizes[2], sizes[3]))
    # If the film sees none of the four, any of them will do.
    sizes = [dr.select(passes[h], dr.maximum(sizes[h], _LEAST * most) + 1e-12, 0.0) for h in every]
    total = sum(sizes)
    share = 1 / dr.select(total > 0, total, 1)
    probability = [size * share for size in sizes]

    # The choice uses the number's fine part, with which the wavelengths hardly change.
    fine = number * _STEPS
    left = fine - dr.floor(fine)
    heroes: list[Any] = []
    for h in every:
        # After the last ray that passes, only rounding error is left.
        left = left - probability[h]
        heroes.append(passes[h] & (left < 1e-6))
        left = dr.select(heroes[h], 4.0, left)
    factors = []
    for k in every:
        with_hero = sum(dr.select(heroes[h], together[h, k], 0.0) for h in every)
        factors.append(with_hero * counts(probability, k))
    return heroes, factors
