"""Diffraction of a lens by this library beside prysm, Optiland and RayOptics, as a table.

$ python wave_peers.py tessar.50mm 8 10

The arguments are a lens, its f-number, and the height on the film, mm, of a second image point after that on the axis.
The object is at infinity, and the film in the paraxial focus. Each of the others (`pip install prysm optiland
rayoptics`) may be absent.

prysm propagates this library's own wavefront: exact rays give path difference and amplitude on a square grid of
direction cosines. Optiland and RayOptics trace the lens by themselves, from the file that `realistic convert` writes,
with a stop of the same size.
"""

from __future__ import annotations

import contextlib
import importlib.metadata
import io
import json
import subprocess
import sys
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import realistic
from realistic.blender import program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FREQUENCIES = (20.0, 40.0, 80.0)
"""Cycles per mm."""
START_MM = 20.0
"""z of the plane in which rays start."""
ARMS, NODES, DEGREE = 96, 24, 14
"""Rays of the wavefront, along arms from the chief ray to the edge of the pupil, and the degree of the fit."""
STEPS = 80
"""Samples of prysm's pupil in the lowest frequency times the wavelength."""


@dataclass
class Found:
    """Figures of a program for an image point; None where it has no such figure. The MTF is (2, frequencies): tangential
    and sagittal."""

    peak_to_valley: float | None = None
    rms: float | None = None
    strehl: float | None = None
    mtf: Array | None = None
    note: str = ""


@dataclass
class Point:
    """An object at infinity and its image."""

    lens: realistic.Lens
    film_distance: float
    degrees: float
    height: float
    chief: Array
    """Where the chief ray starts, x and y."""

    def rays(self, starts: Array) -> realistic.LensRays:
        """Traces rays from points (n, 2) of the starting plane."""
        origins = np.column_stack([starts, np.full(len(starts), START_MM)])
        return self.lens.trace(origins, self.direction, points=True, optical_path=True)

    @property
    def direction(self) -> Array:
        """Direction of the light; the image is upside down."""
        angle = np.radians(self.degrees)
        return np.array([0.0, np.sin(angle), -np.cos(angle)])

    def landing(self, rays: realistic.LensRays) -> Array:
        """Returns where rays meet the film, (n, 3)."""
        film = self.lens.rear_vertex_mm - self.film_distance
        along = (film - rays.origin[:, 2]) / rays.direction[:, 2]
        return np.asarray(rays.origin + along[:, None] * rays.direction)


def point_at(lens: realistic.Lens, film_distance: float, height: float) -> Point:
    """Finds the direction of the light whose chief ray, through the middle of the stop, meets the film at a height."""
    stop = next(number for number, surface in enumerate(lens.surfaces) if surface.is_stop)
    point = Point(lens, film_distance, 0.0, height, np.zeros(2))
    degrees = [0.0, np.degrees(np.arctan(height / lens.focal_length_mm))]
    misses: list[float] = []
    for step in range(20):
        point.degrees = degrees[step]
        for _ in range(20):
            near = np.array([[0.0, 0.0], [0.0, 1e-3]]) + point.chief
            met = point.rays(near).points
            assert met is not None
            slope = (met[1, stop, 1] - met[0, stop, 1]) / 1e-3
            point.chief[1] -= met[0, stop, 1] / slope
        misses.append(float(point.landing(point.rays(point.chief[None]))[0, 1]) - height)
        if abs(misses[-1]) < 1e-12 or height == 0.0:
            break
        if step > 0:
            # The secant.
            change = misses[-1] * (degrees[-1] - degrees[-2]) / (misses[-1] - misses[-2])
            degrees.append(degrees[-1] - change)
    return point


def terms(x: Array, y: Array) -> Array:
    """Returns the Chebyshev polynomials in two variables up to a total degree, (n, terms)."""
    whole = np.polynomial.chebyshev.chebvander2d(x, y, [DEGREE, DEGREE])
    i, j = np.divmod(np.arange((DEGREE + 1) ** 2), DEGREE + 1)
    return np.asarray(whole[..., i + j <= DEGREE])


def wavefront(point: Point) -> tuple[Array, Array, float]:
    """Returns amplitude and path difference, mm, on a square grid of direction cosines, and the grid's step."""
    turns = np.arange(ARMS) * (2 * np.pi / ARMS)
    arms = np.column_stack([np.cos(turns), np.sin(turns)])
    low, high = np.zeros(ARMS), np.full(ARMS, 2 * point.lens.pupils.entrance_diameter_mm)
    for _ in range(50):
        middle = (low + high) / 2
        inside = point.rays(point.chief + middle[:, None] * arms).passed
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    nodes = (np.polynomial.legendre.leggauss(NODES)[0] + 1) / 2
    starts = [point.chief[None], *(point.chief + (share * low)[:, None] * arms for share in (*nodes, 1.0))]
    rays = point.rays(np.concatenate(starts))
    assert rays.passed.all() and rays.optical_path is not None
    image = point.landing(rays)[0]
    # From the plane of the wave through the origin to the point on the ray, and on along the ray's plane wave.
    began = np.column_stack([np.concatenate(starts), np.full(len(rays), START_MM)]) @ point.direction
    path = began + rays.optical_path + ((image - rays.origin) * rays.direction).sum(axis=1)
    path -= path[0]
    cosines = rays.direction[:, :2]
    rim = cosines[-ARMS:]
    centre, half = (rim.max(axis=0) + rim.min(axis=0)) / 2, 1.02 * np.ptp(rim, axis=0).max() / 2
    matrix = terms(*((cosines - centre) / half).T)
    fit = np.linalg.lstsq(matrix, np.column_stack([path, np.concatenate(starts)]), rcond=None)[0]
    step = point.lens.wavelength * 1e-6 * FREQUENCIES[0] / STEPS
    count = int(np.ceil(half / step))
    axis = np.arange(-count, count) * step
    x, y = np.meshgrid(axis, axis)
    around = rim - centre
    order = np.argsort(np.arctan2(around[:, 1], around[:, 0]))
    edge = np.interp(
        np.arctan2(y, x),
        np.arctan2(around[order, 1], around[order, 0]),
        np.hypot(*around[order].T),
        period=2 * np.pi,
    )
    inside = np.hypot(x, y) <= edge
    matrix = np.zeros((*x.shape, fit.shape[1]))
    matrix[inside] = terms(x[inside] / half, y[inside] / half) @ fit
    # The light in a part of the pupil is that in the part of the beam from which it comes.
    (ay, ax), (by, bx) = (np.gradient(matrix[..., k], step) for k in (1, 2))
    inner = inside & np.roll(inside, 1, 0) & np.roll(inside, -1, 0) & np.roll(inside, 1, 1) & np.roll(inside, -1, 1)
    area = np.abs(ax * by - ay * bx)
    amplitude = np.where(inside, np.sqrt(np.where(inner, area, np.median(area[inner]))), 0.0)
    return amplitude, np.where(inside, matrix[..., 0], 0.0), step


def ours(point: Point) -> tuple[Found, realistic.Psf]:
    """Asks this library."""
    from realistic import _waves

    lens = {**point.lens._parameters, "film_distance": point.film_distance}
    at = (0.0, point.height)
    table = _waves.mtf(lens, FREQUENCIES, at, float("inf"), None, 256, (0.0,))[0]
    spread = _waves.psf(lens, at, float("inf"), None, 256, 128, None)
    front = spread.wavefront
    mtf = np.stack([table.tangential, table.sagittal])
    return Found(front.peak_to_valley, front.rms, front.strehl, mtf), spread


def by_prysm(point: Point, spread: realistic.Psf) -> Found:
    """Propagates this library's wavefront by prysm."""
    from prysm.otf import mtf_from_psf
    from prysm.propagation import Wavefront

    amplitude, path, step = wavefront(point)
    wavelength = point.lens.wavelength * 1e-3
    # With a focal length of 1 mm, the pupil's mm are direction cosines.
    waves = [Wavefront.from_amp_and_phase(amplitude, phase, wavelength, step) for phase in (1e6 * path, 0.0 * path)]
    # This library's pixels have their middles between those of prysm, whose axes have the other sign.
    size = len(spread.energy)
    shown = [wave.focus_fixed_sampling(1.0, 500 * spread.pitch_mm, 2 * size).intensity.data for wave in waves]
    own = shown[0][1::2, 1::2][::-1, ::-1] / shown[1].max()
    difference = np.abs(own - spread.energy / spread.perfect_peak).max() / own.max()
    transfer = mtf_from_psf(waves[0].focus(1.0, Q=2).intensity)
    middle = len(transfer.data) // 2
    at = [round(frequency / transfer.dx) for frequency in FREQUENCIES]
    mtf = np.array([[transfer.data[middle + k, middle] for k in at], [transfer.data[middle, middle + k] for k in at]])
    strehl = float(shown[0][size, size] / shown[1][size, size])
    return Found(strehl=strehl, mtf=mtf, note=f"PSF differs by {difference:.1e} of its peak")


def file_for(point: Point, folder: str, ending: str) -> Path:
    """Writes the lens as another program's file."""
    file = Path(folder) / f"lens.{ending}"
    command = [str(program()), "convert", str(point.lens._parameters["lens_file"]), str(file), "--force", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    return file


def stop_diameter(point: Point) -> float:
    return 2 * next(surface.semi_diameter_mm for surface in point.lens.surfaces if surface.is_stop)


def by_optiland(point: Point, folder: str) -> Found:
    """Asks Optiland."""
    from optiland.fileio import load_optiland_file
    from optiland.mtf import FFTMTF
    from optiland.psf import FFTPSF
    from optiland.wavefront import OPD

    file = file_for(point, folder, "json")
    content = json.loads(file.read_text())
    content["aperture"] = {"type": "float_by_stop_size", "value": stop_diameter(point)}
    content["fields"]["fields"] = [{"vx": 0.0, "vy": 0.0, "weight": 1.0, "x": 0.0, "y": point.degrees}]
    file.write_text(json.dumps(content))
    optic = load_optiland_file(str(file))
    wavelength = point.lens.wavelength * 1e-3
    field = (0.0, 1.0 if point.degrees else 0.0)
    opd = OPD(optic, field, wavelength, num_rays=256, distribution="uniform").get_data(field, wavelength)
    seen = np.asarray(opd.opd)[np.asarray(opd.intensity) > 0]
    strehl = FFTPSF(optic, field, wavelength, num_rays=256, grid_size=1024).strehl_ratio()
    transfer = FFTMTF(optic, [field], wavelength, num_rays=256, grid_size=1024)
    axes = (transfer.freq_tang[0], transfer.freq_sag[0])
    curves = [np.interp(FREQUENCIES, np.asarray(axis), np.asarray(curve)) for axis, curve in zip(axes, transfer.mtf[0])]
    return Found(float(np.ptp(seen)), float(seen.std()), float(strehl), np.array(curves))


def by_rayoptics(point: Point, folder: str) -> Found:
    """Asks RayOptics, for its wavefront and its PSF."""
    from rayoptics.gui.appcmds import open_model
    from rayoptics.raytr import analyses
    from rayoptics.raytr.opticalspec import FieldSpec, PupilSpec, WvlSpec

    model = open_model(str(file_for(point, folder, "zmx")))
    optics = model["optical_spec"]
    optics["pupil"] = PupilSpec(optics, key=["object", "epd"], value=point.lens.pupils.entrance_diameter_mm)
    optics["fov"] = FieldSpec(optics, key=["object", "angle"], value=point.degrees or 1.0, flds=[0.0, point.degrees])
    optics["wvls"] = WvlSpec([(point.lens.wavelength, 1.0)], ref_wl=0)
    sequence = model["seq_model"]
    sequence.ifcs[sequence.stop_surface].set_max_aperture(stop_diameter(point) / 2)
    model.update_model()
    rays, size = 128, 1024
    grid = analyses.RayGrid(model, f=1, foc=0.0, num_rays=rays)
    opd = grid.grid[2]
    seen = opd[np.isfinite(opd)]
    strehl = float(abs(np.exp(2j * np.pi * seen).mean()) ** 2)
    spread = analyses.calc_psf(opd, rays, size)
    _, pitch = analyses.calc_psf_scaling(grid, rays, size)
    transfer = np.abs(np.fft.fft2(spread))
    frequencies = np.fft.fftfreq(size, pitch)[: size // 2]
    curves = [np.interp(FREQUENCIES, frequencies, row[: size // 2] / row[0]) for row in (transfer[0], transfer[:, 0])]
    return Found(float(np.ptp(seen)), float(seen.std()), strehl, np.array(curves))


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keeps what the programs print and warn of out of the table."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield


def row(height: float, name: str, found: Found) -> str:
    def text(number: float | None) -> str:
        return "" if number is None else f"{number:.4f}"

    curves = (
        [", ".join(f"{value:.4f}" for value in curve) for curve in found.mtf] if found.mtf is not None else ["", ""]
    )
    cells = [
        f"{height:g} mm",
        name,
        text(found.peak_to_valley),
        text(found.rms),
        text(found.strehl),
        *curves,
        found.note,
    ]
    return "| " + " | ".join(cells) + " |"


def main(name: str, fnumber: float, height: float) -> None:
    lens = realistic.Lens(name, fnumber=fnumber)
    film_distance = lens.back_focal_distance_mm
    known = ("prysm", "Optiland", "RayOptics")
    versions = {}
    for peer in known:
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            versions[peer] = importlib.metadata.version(peer.lower())
    print(", ".join([f"realistic {realistic.__version__}", *(f"{peer} {each}" for peer, each in versions.items())]))
    print(f"{name}, f/{fnumber:g}, {lens.wavelength:g} nm, film {film_distance:.5f} mm behind the last vertex\n")
    print("| place | program | peak to valley, waves | RMS | Strehl ratio | tangential MTF | sagittal MTF | |")
    print("|---|---|--:|--:|--:|---|---|---|")
    for at in dict.fromkeys((0.0, height)):
        point = point_at(lens, film_distance, at)
        found, spread = ours(point)
        print(row(at, "realistic", found))
        for peer in versions:
            with quiet(), tempfile.TemporaryDirectory() as folder:
                if peer == "prysm":
                    other = by_prysm(point, spread)
                else:
                    other = {"Optiland": by_optiland, "RayOptics": by_rayoptics}[peer](point, folder)
            print(row(at, peer, other))


if __name__ == "__main__":
    given: Any = sys.argv[1:]
    if len(given) != 3:
        print(
            "usage: python wave_peers.py LENS FNUMBER HEIGHT_MM, as in: python wave_peers.py tessar.50mm 8 10",
            file=sys.stderr,
        )
        sys.exit(2)
    main(given[0], float(given[1]), float(given[2]))
