"""Files of the folder files/ as read by optiland's and rayoptics' own readers; writes files_<program>.csv.

A row is a quantity (focal length, back focal distance, mm) or a ray from the scene to the film in lens space, as in
rays.py.  Both programs keep the file's unit, so the lengths of a file in inches are multiplied by 25.4 here.  Rays
pass all clear apertures.
"""

import math
import random
from pathlib import Path

import numpy as np
from optiland.fileio import load_zemax_file
from optiland.rays import RealRays
from rayoptics.gui.appcmds import open_model
from rayoptics.optical.obench import read_lens as read_bench
from rayoptics.raytr.opticalspec import WvlSpec
from rayoptics.raytr.raytrace import trace as rayoptics_trace

FOLDER = Path(__file__).parent / "files"
WAVELENGTH = 587.56
# Wavelength at which rayoptics gives a glass of two numbers exactly its n_d, as this library does at 587.56 nm.
RAYOPTICS_D = 587.5618
# File, unit in mm, half field in degrees, and radius of the beam at the first vertex in mm.
FILES = (("aspheres.zmx", 1.0, 8.0, 5.0), ("inches.zmx", 25.4, 10.0, 3.5), ("bench.txt", 1.0, 8.0, 5.0))


def rays(name: str, half_field: float, radius: float) -> np.ndarray:
    rng = random.Random(name)
    found = []
    for k in range(30):
        field, azimuth = math.radians(half_field) * (k % 3) / 2, math.tau * rng.random()
        size, angle = radius * math.sqrt(rng.random()), math.tau * rng.random()
        direction = np.array([math.sin(field) * math.cos(azimuth), math.sin(field) * math.sin(azimuth),
                              -math.cos(field)])
        direction /= math.sqrt(math.fsum(direction ** 2))
        through = np.array([size * math.cos(angle), size * math.sin(angle), 0.0])
        found.append([*(through - 10.0 * direction), *direction])
    return np.array(found)


def sections(path: Path) -> dict[str, list]:
    """Returns Optical Bench text in the form in which rayoptics downloads it: lines of cells by heading."""
    found = {}
    for line in path.read_text().splitlines():
        if line.startswith("["):
            key = line.strip("[]")
            found[key] = []
        else:
            found[key].append(line.split("\t"))
    return found


def by_optiland(path: Path, unit: float, inputs: np.ndarray) -> tuple[list[float], np.ndarray]:
    optic = load_zemax_file(str(path))
    x, y, z, dx, dy, dz = (np.ascontiguousarray(c) for c in inputs.T)
    bundle = RealRays(x / unit, y / unit, -z / unit, dx, dy, -dz, np.ones(len(x)), np.full(len(x), WAVELENGTH * 1e-3))
    group = optic.surfaces
    group.trace(bundle)
    rear = group.x.shape[0] - 2
    parax = optic.paraxial
    to_image = np.asarray(group.positions).ravel()
    first_order = [np.asarray(parax.f2()).item() * unit,
                   (np.asarray(parax.F2()).item() + to_image[rear + 1] - to_image[rear]) * unit]
    return first_order, np.column_stack([group.x[rear] * unit, group.y[rear] * unit, -group.z[rear] * unit,
                                         group.L[rear], group.M[rear], -group.N[rear]])


def by_rayoptics(path: Path, unit: float, inputs: np.ndarray) -> tuple[list[float], np.ndarray]:
    if path.suffix == ".zmx":
        model, wavelength = open_model(str(path)), WAVELENGTH
    else:
        model, wavelength = read_bench(sections(path)), RAYOPTICS_D
    model["optical_spec"]["wvls"] = WvlSpec([(wavelength, 1.0)], ref_wl=0)
    # With its customary infinity of 1e10, the program computes first-order data to six digits only.
    sequence = model["seq_model"]
    sequence.gaps[0].thi = 1000.0
    model.update_model()
    fod = model["analysis_results"]["parax_data"].fod
    first_order = [fod.efl * unit, fod.bfl * unit]
    sequence.gaps[0].thi = 0.0
    sequence.update_model()
    rear = len(sequence.ifcs) - 2
    rear_vertex = -sum(gap.thi for gap in sequence.gaps[1:rear])
    found = []
    for x, y, z, dx, dy, dz in inputs:
        path_, _, _ = rayoptics_trace(sequence, np.array([x, y, -z]) / unit, np.array([dx, dy, -dz]), wavelength,
                                      intersect_obj=False)
        (px, py, pz), (ux, uy, uz) = path_[rear][:2]
        found.append([px * unit, py * unit, (rear_vertex - pz) * unit, ux, uy, -uz])
    return first_order, np.array(found)


def main():
    for program, compute in (("optiland", by_optiland), ("rayoptics", by_rayoptics)):
        lines = ["file,what,x,y,z,dx,dy,dz,ox,oy,oz,ux,uy,uz"]
        for name, unit, half_field, radius in FILES:
            if program == "optiland" and name.endswith(".txt"):
                continue
            inputs = rays(name, half_field, radius)
            first_order, results = compute(FOLDER / name, unit, inputs)
            for what, value in zip(("focal_length", "back_focal_distance"), first_order, strict=True):
                lines.append(f"{name},{what},{value:.17g}" + "," * 11)
            assert np.isfinite(results).all()
            for row in np.column_stack([inputs, results]):
                lines.append(",".join([name, "ray"] + [f"{v:.17g}" for v in row]))
        (Path(__file__).parent / f"files_{program}.csv").write_text("\n".join(lines) + "\n", newline="\n")


if __name__ == "__main__":
    main()
