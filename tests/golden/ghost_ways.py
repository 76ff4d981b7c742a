"""Ghosts of a lamp by the methods of three flare programs, each in a few lines, and by the exact product of all
surfaces.

    python tests/golden/ghost_ways.py

Prints the table of benches/record/2026-11-27-light.md: watts of all pairs on film, per 1 W that enters dgauss.50mm. It
needs only NumPy, and shares no code with the library. The programs' methods were read in their sources, and are
modelled here in other words:

- physical-camera (github.com/sidp/physical-camera, addon/lens_camera.osl.template, commit db6f9ae): a bare surface
  reflects the mean of s and p. A coated surface reflects as a film at normal incidence, of which only the phase changes
  with the angle; three layers multiply the bare surface's reflectance by the cube of the film's share of it. The sum is
  divided by the lens's transmission on the axis. Rays lie within a paraxial disk in the exit pupil's plane. A lamp is
  counted by uniform samples and again by aimed samples, which have the weight of the whole disk.
- ghostlight (github.com/JaydenB/ghostlight, src/ghost.cpp, ghost_render.cu, tmm.h, commit 0c2dc68): each surface
  reflects the mean of s and p, by the transfer matrix. A pair is multiplied by the area of its axial ghost's box over
  the sensor's area, from 1 to 100, and all pairs are multiplied by 1000.
- FlareSim (github.com/LocalStarlight/flaresim_nuke, src/fresnel.h, trace.cpp, ghost.cpp, commit 0e28ead): a bare
  surface reflects the mean of s and p, a coated surface s alone; each further layer in the lens file's column leaves a
  quarter of that. The factors are ghostlight's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Pair = tuple[int, int] | None

LENS = Path(__file__).parents[2] / "crates" / "optics" / "lenses" / "dgauss.50mm.dat"
WAVELENGTH, DESIGN, FLUORIDE = 587.56, 550.0, 1.38
# The disk of the film, and the sensor of FlareSim and ghostlight, mm; the sun's angular radius.
SPOT, SENSOR, SUN = 20.0, 36.0 * 24.0, np.radians(0.265)
# Layers from the air on, by index and thickness in waves: no coating, one layer, and the three layers of a broadband
# coating.
STACKS = {0: [], 1: [(FLUORIDE, 0.25)], 3: [(FLUORIDE, 0.25), (2.05, 0.5), (1.63, 0.25)]}
FIELDS, COUNT = (0.0, 12.0), 10_000


@dataclass
class Surface:
    """A row of the lens table; z grows toward the film."""

    z: float
    curvature: float
    media: tuple[float, float]
    semi: float


@dataclass
class Meeting:
    """Rays at a surface: the indices in front of and behind it, the points, the cosines there, s, and the
    directions."""

    surface: Surface
    is_mirror: bool
    indices: tuple[float, float]
    point: Real
    cosines: tuple[Real, Real]
    s: Real
    directions: tuple[Real, Real]

    @property
    def is_in_air(self) -> bool:
        return 1.0 in self.indices

    @property
    def height(self) -> Real:
        return np.hypot(self.point[:, 0], self.point[:, 1])


Reflectance = Callable[[Meeting, int], Real]


def read() -> list[Surface]:
    found, z, before = [], 0.0, 1.0
    for line in LENS.read_text().splitlines():
        if not line.startswith("#"):
            radius, thickness, index, diameter = (float(cell) for cell in line.split())
            behind = index or 1.0
            found.append(Surface(z, 1 / radius if radius else 0.0, (before, behind), diameter / 2))
            z, before = z + thickness, behind
    return found


SURFACES = read()
MIRRORS = [i for i, surface in enumerate(SURFACES) if len(set(surface.media)) == 2]
PAIRS = [(a, b) for a in MIRRORS for b in MIRRORS if a < b]


def dot(a: Real, b: Real) -> Real:
    return np.asarray(np.einsum("...k,...k", a, b))


def trace(pair: Pair, p: Real, d: Real) -> tuple[list[Meeting], Real, Real]:
    """Traces rays through the lens, reflected at the farther surface of the pair and then at the nearer; NaN for a ray
    that misses."""
    count = len(SURFACES)
    order = [(i, False, 1) for i in range(count)]
    if pair:
        near, far = pair
        back = [(i, i == near, -1) for i in range(far - 1, near - 1, -1)]
        order = [(i, i == far, 1) for i in range(far + 1)] + back + [(i, False, 1) for i in range(near + 1, count)]
    met = []
    for i, is_mirror, way in order:
        surface = SURFACES[i]
        c, q = surface.curvature, p - [0.0, 0.0, surface.z]
        half, rest = c * dot(q, d) - d[:, 2], c * dot(q, q) - 2 * q[:, 2]
        q = q + (rest / (way * np.sqrt(half**2 - c * rest) - half))[:, None] * d
        normal = way * (np.array([0.0, 0.0, 1.0]) - c * q)
        n, other = surface.media[::way]
        ratio, cosine = n / other, dot(normal, d)
        beyond = np.sqrt(1 - ratio**2 * (1 - cosine**2))
        across = np.cross(normal, d)
        across[dot(across, across) < 1e-24] = [0.0, 1.0, 0.0]
        s = across / np.sqrt(dot(across, across))[:, None]
        out = ratio * d + (beyond - ratio * cosine)[:, None] * normal
        if is_mirror:
            out = d - 2 * cosine[:, None] * normal
        met.append(Meeting(surface, is_mirror, (n, other), q, (cosine, beyond), s, (d, out)))
        p, d = q + [0.0, 0.0, surface.z], out
    return met, p, d


def amplitudes(meeting: Meeting, layers: int, is_p: bool) -> tuple[Complex, Complex]:
    """Returns r and t by the transfer matrix, with one of STACKS on surfaces in air; the square of |t| is a power."""
    n, other = meeting.indices

    def admittance(index: float, cosine: Real) -> Real:
        return index / cosine if is_p else index * cosine

    first, last = admittance(n, meeting.cosines[0]), admittance(other, meeting.cosines[1])
    b, c = np.ones_like(first, dtype=complex), last.astype(complex)
    stack = STACKS[layers] if meeting.is_in_air else []
    # The layers are ordered from the side toward which the light leaves.
    for index, waves in stack if n > other else stack[::-1]:
        cosine = np.sqrt(1 - (n / index) ** 2 * (1 - meeting.cosines[0] ** 2))
        phase, own = 2 * np.pi * waves * DESIGN / WAVELENGTH * cosine, admittance(index, cosine)
        turn = 1j * np.sin(phase)
        b, c = np.cos(phase) * b + turn / own * c, turn * own * b + np.cos(phase) * c
    return (first * b - c) / (first * b + c), 2 * np.sqrt(first * last) / (first * b + c)


def of_ghostlight(meeting: Meeting, layers: int) -> Real:
    s, p = (np.abs(amplitudes(meeting, layers, is_p)[0]) ** 2 for is_p in (False, True))
    mean: Real = (s + p) / 2
    return mean


def of_flaresim(meeting: Meeting, layers: int) -> Real:
    if not (layers and meeting.is_in_air):
        return of_ghostlight(meeting, 0)
    film: Real = np.abs(amplitudes(meeting, 1, is_p=False)[0]) ** 2
    return film * 0.25 ** (layers - 1)


def of_physical_camera(meeting: Meeting, layers: int) -> Real:
    if not (layers and meeting.is_in_air):
        return of_ghostlight(meeting, 0)
    low, high = sorted(meeting.indices)
    sine = meeting.indices[0] / FLUORIDE * np.sqrt(1 - meeting.cosines[0] ** 2)
    turn = np.cos(np.pi * DESIGN / WAVELENGTH * np.sqrt(1 - sine**2))
    one, two = (low - FLUORIDE) / (low + FLUORIDE), (FLUORIDE - high) / (FLUORIDE + high)
    film: Real = (one**2 + two**2 + 2 * one * two * turn) / (1 + (one * two) ** 2 + 2 * one * two * turn)
    bare = ((low - high) / (low + high)) ** 2
    return film if layers == 1 else np.minimum(bare * (film / bare) ** 3, of_ghostlight(meeting, 0))


def product(met: list[Meeting], reflectance: Reflectance, layers: int) -> Real:
    """Returns the share of light that rays keep if each surface multiplies it by one number."""
    left = np.ones(len(met[0].point))
    for meeting in met:
        if len(set(meeting.indices)) == 2:
            r = reflectance(meeting, layers)
            left = left * (r if meeting.is_mirror else 1 - r)
    return left


def exact(met: list[Meeting], layers: int) -> Real:
    """Returns the same share with the electric field carried from surface to surface, as the mean of two
    polarisations."""
    left = np.zeros(len(met[0].point))
    d = met[0].directions[0]
    for start in np.eye(3)[:2]:
        field = (start - (d @ start)[:, None] * d).astype(complex)
        field /= np.sqrt(np.sum(np.abs(field) ** 2, axis=1))[:, None]
        for meeting in met:
            if len(set(meeting.indices)) == 2:
                way, (before, behind) = int(not meeting.is_mirror), meeting.directions
                a_s, a_p = (amplitudes(meeting, layers, is_p)[way] for is_p in (False, True))
                e_s = np.sum(field * meeting.s, axis=1) * a_s
                e_p = np.sum(field * np.cross(meeting.s, before), axis=1) * a_p
                field = e_s[:, None] * meeting.s + e_p[:, None] * np.cross(meeting.s, behind)
        left += np.sum(np.abs(field) ** 2, axis=1) / 2
    return left


def paraxial(pair: Pair) -> tuple[Real, list[Real]]:
    """Returns the matrix from (height, slope) before the lens to that behind the last vertex; and each surface's
    heights for both."""
    step = 1e-5
    d = np.array([[0.0, 0.0, 1.0], [step, 0.0, 1.0]])
    start = np.array([[step, 0.0, 0.0], [0.0, 0.0, 0.0]])
    met, end, out = trace(pair, start, d / np.sqrt(dot(d, d))[:, None])
    return np.array([end[:, 0], out[:, 0] / out[:, 2]]) / step, [meeting.point[:, 0] / step for meeting in met]


REAR = SURFACES[-1].z
FOCUS = REAR - float(np.divide(*paraxial(None)[0][:, 0]))


def exit_pupil() -> tuple[float, float]:
    """Returns z and semi-diameter of the image of the stop."""
    matrix, heights = paraxial(None)
    stop = next(i for i, surface in enumerate(SURFACES) if len(set(surface.media)) == 1)
    across, along = heights[stop]
    end, slope = matrix @ [-along / across, 1.0]
    edge, tilt = matrix @ [SURFACES[stop].semi / across, 0.0]
    return REAR - end / slope, abs(edge - tilt * end / slope)


def aim(pair: Pair) -> tuple[float, float, float]:
    """Returns physical-camera's disk for a pair, as z and semi-diameter, and how often its aimed samples count the
    sun's light."""
    z, semi = exit_pupil()
    matrix, heights = paraxial(pair)
    # A ray starts in the film's middle and is 1 mm from the axis in the disk's plane.
    slope = 1 / (z - FOCUS)
    start = np.linalg.solve(matrix, [(REAR - FOCUS) * slope, slope])
    met = trace(pair, np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]))[0]
    reached = [(abs(own @ start), meeting.surface.semi) for own, meeting in zip(heights, met, strict=True)]
    within = min([semi] + [clear / float(height) for height, clear in reached if height > 1e-10])
    disk = min(1.1 * within, semi)
    return z, disk, float(disk * abs(start[1]) / SUN) ** 2


def on_film(end: Real, out: Real, z: float = FOCUS) -> Real:
    return np.asarray(end + ((z - end[:, 2]) / out[:, 2])[:, None] * out)


def passes(met: list[Meeting]) -> NDArray[np.bool_]:
    return np.asarray(np.all([meeting.height <= meeting.surface.semi for meeting in met], axis=0))


def boost(pair: Pair) -> float:
    """Returns the area of the axial ghost's box relative to the sensor's area, from 1 to 100, as ghostlight and
    FlareSim compute it."""
    side = (np.arange(8) + 0.5) / 4 - 1
    x, y = (SURFACES[0].semi * grid.ravel() for grid in np.meshgrid(side, side))
    start = np.stack([x, y, 0 * x - 1], axis=1)[np.hypot(x, y) <= SURFACES[0].semi]
    met, end, out = trace(pair, start, np.tile([0.0, 0.0, 1.0], (len(start), 1)))
    at = on_film(end, out)
    at = at[passes(met) & np.isfinite(at[:, 0])]
    return float(np.clip(np.prod(np.ptp(at[:, :2], axis=0)) / SENSOR, 1, 100)) if len(at) > 1 else 1.0


def shares(field: float, layers: int) -> dict[str, float]:
    """Returns the watts on film by each method, per 1 W that enters."""
    # A spiral of equal areas, by the golden angle.
    turn = np.arange(COUNT) + 0.5
    radius, angle = SURFACES[0].semi * np.sqrt(turn / COUNT), np.pi * (3 - np.sqrt(5)) * turn
    sagitta = SURFACES[0].semi ** 2 * SURFACES[0].curvature / 2
    direction = np.array([np.sin(np.radians(field)), 0.0, np.cos(np.radians(field))])
    start = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * radius + sagitta], axis=1) - 40 * direction
    d = np.tile(direction, (COUNT, 1))
    axial = trace(None, np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]))[0]
    on_axis = float(product(axial, of_physical_camera, layers)[0])
    found: dict[str, float] = {}
    for pair in PAIRS:
        met, end, out = trace(pair, start, d)
        at = on_film(end, out)
        lands = passes(met) & (np.hypot(at[:, 0], at[:, 1]) <= SPOT) & (out[:, 2] > 0)
        # The light that is left is computed only for the rays that arrive.
        met, end, out = trace(pair, start[lands], d[lands])
        z, disk, again = aim(pair)
        crossing = on_film(end, out, z)
        in_disk = np.hypot(crossing[:, 0], crossing[:, 1]) <= disk
        box = boost(pair)

        def watts(left: Real) -> float:
            return float(np.sum(left)) / COUNT

        lamp = watts(product(met, of_physical_camera, layers) * in_disk) / on_axis
        mean = watts(product(met, of_ghostlight, layers))
        column = watts(product(met, of_flaresim, layers))
        for name, value in {
            "exact, two reflections": watts(exact(met, layers)),
            "physical-camera, by chance": lamp,
            "physical-camera, aimed at the sun": lamp * (1 + again),
            "ghostlight, gain 1, no boost": mean,
            "ghostlight as it is": 1000 * box * mean,
            "FlareSim, gain 1, no boost": column,
            "FlareSim as it is": 1000 * box * column,
        }.items():
            found[name] = found.get(name, 0.0) + value
    return found


def main() -> None:
    cases = [(field, layers) for layers in (0, 1, 3) for field in FIELDS]
    with np.errstate(invalid="ignore", divide="ignore"):
        columns = [shares(field, layers) for field, layers in cases]
    print("| way | " + " | ".join(f"{field:g}°, {layers} layers" for field, layers in cases) + " |")
    print("|---" * (1 + len(cases)) + "|")
    for name in columns[0]:
        print(f"| {name} | " + " | ".join(f"{column[name]:.2e}" for column in columns) + " |")


if __name__ == "__main__":
    main()
