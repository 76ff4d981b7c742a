"""Which wavelengths of a path go together through a lens that sends each another way.

A path of Mitsuba's has four wavelengths and one ray. A ray is traced at each of the four. Two wavelengths go together where the
lens puts their rays on points of the plane in focus that lie less than a tolerance apart, measured in pixels there. One of
the four, the hero (A. Wilkie et al., "Hero Wavelength Spectral Sampling", 2014), gives the path its ray, and the path carries
the wavelengths that go together with the hero. With q_h the probability of hero h, A_hk 1 where h and k go together (k goes with
itself) and 0 elsewhere, wavelength k counts

    A_hk / sum over h' of q_h' A_h'k,

the balance heuristic: its mean over the heroes is 1 whatever q and A are. The probability decides on the noise alone. It is in
proportion to what a path of hero h would carry in the film's channels if all heroes were equally probable, which is the
probability of least variance where the wavelengths fall into groups.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

WAVELENGTHS = (380.0, 780.0)
"""Wavelengths, nm, at which rays can be asked for; Mitsuba's reach a little further, where eyes see nothing."""

# The least probability of a hero, over that of the most probable: it bounds the weight of what only this hero carries.
_LEAST = 0.02

# Weights of the squares of X, Y and Z in the amount that a path carries: more on Y lowers the noise of luminance and raises that
# of colour, which is the higher of the two without dispersion, too.
_CHANNELS = (1.0, 20.0, 1.0)

# In how many steps of the wavelengths' number a hero is chosen anew: in a step they change by a nanometre or two, and of the
# number's 23 bits 15 are left to choose by.
_STEPS = 256.0


def amounts(spectral: bool, wavelengths: Any, response: Any) -> list[list[Any]]:
    """What each wavelength adds to each of a film's channels, up to a factor; of a spectral film, just its response."""
    if spectral:
        return [[response[k]] for k in range(len(wavelengths))]
    found = []
    for k in range(len(wavelengths)):
        xyz = mi.cie1931_xyz(wavelengths[k])
        found.append([scale**0.5 * response[k] * xyz[channel] for channel, scale in enumerate(_CHANNELS)])
    return found


def landing(point: Callable[[Any], Any], rays: Sequence[Any], right: Any, down: Any) -> tuple[list[Any], Any]:
    """Where rays (7 columns each) land beside the first of them, pixels (x, y), and whether that is known.

    `point` gives the point at which a ray is looked at; `right` and `down` are the first ray's neighbours, one pixel away.
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
    places: Sequence[Any],
    known: Any,
    each: Sequence[Sequence[Any]],
    number: Any,
    tolerance: float,
) -> tuple[list[Any], list[Any]]:
    """The hero of a path, as masks of which one is true, and the factor of each wavelength: 0 where it is not carried.

    Parameters
    ----------
    weights : weights of the rays; 0 for one that is blocked, which goes together with none.
    places, known : as by `landing`; where they are not known no two wavelengths go together.
    each : as by `amounts`.
    number : the number in [0, 1) of which the wavelengths were made.
    tolerance : pixels; 0: each wavelength goes alone.
    """
    every = range(len(weights))
    passes = [weight > 0 for weight in weights]
    together: dict[tuple[int, int], Any] = {}
    for h in every:
        together[h, h] = dr.select(passes[h], 1.0, 0.0)
        for k in range(h):
            apart = dr.square(places[h][0] - places[k][0]) + dr.square(places[h][1] - places[k][1])
            joined = known & passes[h] & passes[k] & (apart < tolerance * tolerance)
            together[h, k] = together[k, h] = dr.select(joined, 1.0, 0.0)

    def counts(probability: Sequence[Any], k: int) -> Any:
        """The inverse of the probability that wavelength k is carried."""
        total = sum(probability[h] * together[h, k] for h in every)
        return dr.select(total > 0, 1 / dr.select(total > 0, total, 1), 0.0)

    even = [counts([1.0] * len(weights), k) * weights[k] for k in every]
    sizes = []
    for h in every:
        parts = [sum(together[h, k] * even[k] * each[k][channel] for k in every) for channel in range(len(each[0]))]
        sizes.append(dr.sqrt(sum(dr.square(part) for part in parts)))
    most = dr.maximum(dr.maximum(sizes[0], sizes[1]), dr.maximum(sizes[2], sizes[3]))
    # Where the film sees none of the four, any will do.
    sizes = [dr.select(passes[h], dr.maximum(sizes[h], _LEAST * most) + 1e-12, 0.0) for h in every]
    total = sum(sizes)
    share = 1 / dr.select(total > 0, total, 1)
    probability = [size * share for size in sizes]

    # The number's fine part, with which wavelengths hardly change, chooses.
    fine = number * _STEPS
    left = fine - dr.floor(fine)
    heroes: list[Any] = []
    for h in every:
        # All of it is used up with the last ray that passes, but for rounding.
        left = left - probability[h]
        heroes.append(passes[h] & (left < 1e-6))
        left = dr.select(heroes[h], 4.0, left)
    factors = []
    for k in every:
        with_hero = sum(dr.select(heroes[h], together[h, k], 0.0) for h in every)
        factors.append(with_hero * counts(probability, k))
    return heroes, factors
