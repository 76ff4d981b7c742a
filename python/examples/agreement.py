"""The lens files of a folder in this library beside Optiland and RayOptics: focal lengths, entrance pupils, rays.

$ python agreement.py FOLDER

Optiland (`pip install optiland`) and RayOptics (`pip install rayoptics`) read the files by themselves; either may be
absent. A format that a program does not read is given to it as Zemax text, which `realistic convert` writes; such cells
have a star. With `--samples`, Optiland first writes the samples that come with it into the folder. Nothing is fetched.

The table has, for each program, its focal length minus this library's, relative; the same for the position of the
entrance pupil, mm; and the largest distance between its rays and this library's in the plane of paraxial focus, µm.
There are 40 rays from infinity: on four circles in the entrance pupil, along the axis and at a twentieth radian to it.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.metadata
import io
import math
import subprocess
import sys
import tempfile
import warnings
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import realistic
from realistic.blender import program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

START_MM = 20.0
"""Distance before the first surface at which rays start."""

# Lines of a ray: points (n, 3), directions (n, 3), with z along the light and 0 at the last surface that refracts.
Rays = tuple["NDArray[np.float64]", "NDArray[np.float64]"]


@dataclass
class Found:
    """A lens as a program reads it. `trace` takes rays and returns them behind the lens, both as `Rays` but with z = 0
    at the first vertex and at the last surface that refracts."""

    focal_length: float
    pupil: float
    trace: Callable[[Rays], Rays]


# A program's name, its reader, and the endings of the files that it reads.
Program = tuple[str, "Callable[[Path], Found]", tuple[str, ...]]


@dataclass
class Own(Found):
    """A lens as this library reads it, with the radius of its entrance pupil and the distance of its focus, mm."""

    pupil_radius: float
    focus: float


def ours(file: Path) -> Own:
    """Reads a file by this library."""
    lens = realistic.Lens(file)
    surfaces = [surface for surface in lens.surfaces if surface.index_scene != surface.index_film]
    first, last = surfaces[0].vertex_mm, surfaces[-1].vertex_mm
    mirrored = np.array([1.0, 1.0, -1.0])

    def trace(rays: Rays) -> Rays:
        origins, directions = (part * mirrored for part in rays)
        traced = lens.trace(origins + [0.0, 0.0, first], directions)
        passed = np.where(traced.passed[:, np.newaxis], traced.origin, np.nan)
        return (passed - [0.0, 0.0, last]) * mirrored, traced.direction * mirrored

    pupils, back = lens.pupils, lens.back_focal_distance_mm
    focus = back if math.isfinite(back) else 0.0
    return Own(lens.focal_length_mm, first - pupils.entrance_mm, trace, 0.5 * pupils.entrance_diameter_mm, focus)


def optiland(file: Path) -> Found:
    """Reads a file by Optiland."""
    from optiland import fileio
    from optiland.rays import RealRays

    readers = {
        ".json": fileio.load_optiland_file,
        ".zmx": fileio.load_zemax_file,
        ".seq": fileio.load_codev_file,
        ".len": fileio.load_oslo_file,
    }
    optic = readers[file.suffix.lower()](str(file))
    wavelength = float(np.squeeze(optic.primary_wavelength))
    surfaces = optic.surfaces.surfaces[1:-1]
    index = [float(np.squeeze(surface.material_post.n(wavelength))) for surface in optic.surfaces.surfaces]
    refracting = [surface for surface, (before, behind) in zip(surfaces, pairwise(index)) if before != behind]
    first, last = (float(np.squeeze(surface.geometry.cs.z)) for surface in (refracting[0], refracting[-1]))

    def trace(rays: Rays) -> Rays:
        origins, directions = rays
        count = len(origins)
        own = RealRays(*(origins + [0.0, 0.0, first]).T, *directions.T, np.ones(count), np.full(count, wavelength))
        for surface in surfaces:
            surface.trace(own)
        points = np.column_stack([own.x, own.y, own.z]) - [0.0, 0.0, last]
        return points, np.column_stack([own.L, own.M, own.N])

    pupil = float(np.squeeze(optic.paraxial.EPL())) - first
    return Found(float(np.squeeze(optic.paraxial.f2())), pupil, trace)


def ray_optics(file: Path) -> Found:
    """Reads a file by RayOptics."""
    from rayoptics.gui.appcmds import open_model
    from rayoptics.raytr.raytrace import trace as trace_ray
    from rayoptics.raytr.traceerror import TraceError

    model = open_model(str(file))
    if model is None:
        raise ValueError("RayOptics returns no model")
    unit = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "inches": 25.4}[
        str(model["system_spec"].dimensions).lower()
    ]
    sequence = model["seq_model"]
    optics = model["analysis_results"]["parax_data"].fod
    wavelength = float(sequence.central_wavelength())
    index = [float(gap.medium.rindex(wavelength)) for gap in sequence.gaps]
    vertices = np.concatenate([[0.0], np.cumsum([gap.thi for gap in sequence.gaps[1:]])])
    refracting = [i for i, (before, behind) in enumerate(pairwise(index)) if before != behind]
    first, last = vertices[refracting[0]] * unit, vertices[refracting[-1]] * unit
    found = Found(optics.efl * unit, optics.enp_dist * unit - first, lambda rays: rays)
    # Rays start on the object's plane, which may lie 1e10 in front.
    sequence.gaps[0].thi = START_MM / unit
    model.update_model()

    def one(origin: NDArray[np.float64], direction: NDArray[np.float64]) -> NDArray[np.float64]:
        start = (origin + [0.0, 0.0, first + START_MM]) / unit
        try:
            points = trace_ray(sequence, start, direction, wavelength)[0]
        except TraceError:
            return np.full(6, np.nan)
        point, heading = points[-2][:2]
        z = vertices[len(points) - 3] * unit - last
        return np.concatenate([point * unit + [0.0, 0.0, z], heading])

    def trace(rays: Rays) -> Rays:
        traced = np.array([one(*ray) for ray in zip(*rays)])
        return traced[:, :3], traced[:, 3:]

    found.trace = trace
    return found


def starting_rays(pupil: float, radius: float) -> Rays:
    """Returns the rays that enter, before the first surface."""
    turns = np.arange(5) * (2.0 * np.pi / 5.0)
    points = [(share * np.cos(turn), share * np.sin(turn)) for share in (0.2, 0.4, 0.6, 0.8) for turn in turns]
    origins, directions = [], []
    for slope in (0.0, 0.05):
        for x, y in points:
            origins.append((x * radius, y * radius - slope * (pupil + START_MM), -START_MM))
            directions.append((0.0, slope, 1.0))
    headings = np.array(directions)
    return np.array(origins), headings / np.linalg.norm(headings, axis=1, keepdims=True)


def in_plane(rays: Rays, z: float) -> NDArray[np.float64]:
    """Returns where rays meet a plane across the axis."""
    points, directions = rays
    return points[:, :2] + (z - points[:, 2:]) * directions[:, :2] / directions[:, 2:]


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keeps what the programs print and warn of out of the table."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield


def reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def as_zemax(file: Path, folder: str) -> Path:
    """Returns the same lens as Zemax text, written by the program."""
    out = Path(folder) / "lens.zmx"
    done = subprocess.run([program(), "convert", file, out, "--force"], capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    return out


def compared(own: Own, other: Found, star: str) -> list[str]:
    """Returns the cells of a program."""
    rays = starting_rays(own.pupil, own.pupil_radius)
    places = [in_plane(lens.trace(rays), own.focus) for lens in (own, other)]
    distances = np.linalg.norm(places[0] - places[1], axis=1)
    both = distances[np.isfinite(distances)]
    return [
        f"{other.focal_length / own.focal_length - 1.0:.1e}{star}",
        f"{other.pupil - own.pupil:.1e}{star}",
        f"{1000.0 * both.max():.1e} ({len(both)}){star}" if len(both) else "none pass",
    ]


def write_samples(folder: Path) -> None:
    """Writes the lenses that come with Optiland as its JSON."""
    import importlib
    import inspect
    import pkgutil

    import optiland.samples
    from optiland.fileio import save_optiland_file
    from optiland.optic import Optic

    for module in pkgutil.iter_modules(optiland.samples.__path__):
        within = importlib.import_module(f"optiland.samples.{module.name}")
        for name, kind in inspect.getmembers(within, inspect.isclass):
            if issubclass(kind, Optic) and kind.__module__ == within.__name__:
                with contextlib.suppress(TypeError):  # Some need arguments.
                    save_optiland_file(kind(), str(folder / f"{name}.json"))


def main(folder: Path, samples: bool) -> None:
    if samples:
        folder.mkdir(parents=True, exist_ok=True)
        write_samples(folder)
    programs: list[Program] = []
    versions = [f"realistic {realistic.__version__}"]
    known: tuple[Program, ...] = (
        ("Optiland", optiland, (".json", ".zmx", ".seq", ".len")),
        ("RayOptics", ray_optics, (".zmx", ".seq", ".roa")),
    )
    for program_of in known:
        name = program_of[0]
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            versions.append(f"{name} {importlib.metadata.version(name.lower())}")
            programs.append(program_of)
    print(", ".join(versions), end="\n\n")
    columns = [f"{name}: {what}" for name, *_ in programs for what in ("f", "pupil, mm", "rays, µm")]
    print("| " + " | ".join(["file", "f, mm", *columns]) + " |")
    print("|" + "---|" * (2 + len(columns)))
    reasons = []
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        try:
            with quiet():
                own = ours(file)
        except realistic.Error as error:
            reasons.append(f"- {reason(error)}")
            continue
        cells = [str(file.relative_to(folder)), f"{own.focal_length:.6g}"]
        for name, read, endings in programs:
            try:
                with quiet(), tempfile.TemporaryDirectory() as room:
                    if file.suffix.lower() in endings:
                        cells += compared(own, read(file), "")
                    else:
                        cells += compared(own, read(as_zemax(file, room)), "*")
            except Exception as error:  # A program may raise anything over a file.
                cells += ["", "", ""]
                reasons.append(f"- {file.name}, {name}: {reason(error)}")
        print("| " + " | ".join(cells) + " |")
    if reasons:
        print("\nNot compared:\n\n" + "\n".join(reasons))


if __name__ == "__main__":
    parser: Any = argparse.ArgumentParser(prog="python agreement.py", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--samples", action="store_true", help="let Optiland write its samples there first")
    given = parser.parse_args()
    if not given.folder.is_dir() and not given.samples:
        print(f"{given.folder} is no folder, as in: python agreement.py lenses", file=sys.stderr)
        sys.exit(2)
    main(given.folder, given.samples)
