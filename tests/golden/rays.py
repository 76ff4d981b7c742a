"""Real rays from the scene to the film by optiland and by rayoptics; writes rays_<program>.csv.

Both tables hold the same input rays, all of which pass every aperture.  Lens space has +z toward the scene and both
programs have it toward the image, so z and dz change sign on the way in and on the way out (programs.py).
"""

import math
import random
from pathlib import Path

import numpy as np

from lenses import Lens, configurations
from programs import optiland_rays, rayoptics_rays
from truth import interfaces, trace

# Half-field in degrees up to which the lens still transmits a pencil of reasonable width.
HALF_FIELD = {"dgauss.50mm": 20.0, "wide.22mm": 36.0, "telephoto.250mm": 4.0, "fisheye.10mm": 74.0,
              "dgauss.100mm": 20.0, "planar": 18.0, "crossed": 5.0}
FIELDS = (0.0, 0.3, 0.7, 1.0)
RAYS_A_FIELD = 15
# Relative distance that rays keep from the edges of apertures, so that every program agrees that no ray of the table is
# clipped.
SMALLEST_MARGIN = 1e-4


def passing_rays(lens: Lens) -> np.ndarray:
    # Rays are chosen at n_d for every wavelength, so that a lens's tables can be compared ray by ray.
    system = interfaces(lens)
    rng = random.Random(f"rays {lens.name}")
    front, curve = lens.rows[0].diameter / 2, lens.rows[0].radius
    rays = []
    for fraction in FIELDS:
        field = math.radians(fraction * HALF_FIELD[lens.name])
        count, attempts = 0, 0
        azimuths = (math.pi / 2, 0.35, 3.9)
        middle = {}
        while count < RAYS_A_FIELD:
            attempts += 1
            if attempts > 60000:
                raise RuntimeError(f"{lens.name}: too few rays pass at {fraction} of the field")
            azimuth = azimuths[count % 3]
            direction = np.array([math.sin(field) * math.cos(azimuth), math.sin(field) * math.sin(azimuth),
                                  -math.cos(field)])
            direction /= math.sqrt(math.fsum(direction ** 2))
            if fraction == 0.0 and not rays:
                x, y = 0.0, 0.0
            else:
                # A fisheye's pencil covers little of its front: continue the search near the first ray that passed.
                x, y = middle.get(azimuth, (0.0, 0.0))
                radius = front * math.sqrt(rng.random()) * (0.25 if azimuth in middle else 1.0)
                angle = math.tau * rng.random()
                x, y = x + radius * math.cos(angle), y + radius * math.sin(angle)
            if math.hypot(x, y) > front:
                continue
            # Rays are aimed at the interface and not at its vertex plane, which a steep ray to the rim may cross far
            # away. They start just in front of the interface: far starts would only test how a program moves rays
            # there.
            sag = 0.0 if math.isinf(curve) else curve - math.copysign(math.sqrt(curve ** 2 - x * x - y * y), curve)
            back = (2.0 + 10.0 * rng.random() + max(0.0, sag)) / -direction[2]
            origin = np.array([x, y, -sag]) - back * direction
            found = trace(system, origin.tolist(), direction.tolist(), toward_scene=False)
            if found.status == "ok" and found.margin > SMALLEST_MARGIN:
                rays.append([*origin, *direction])
                middle.setdefault(azimuth, (x, y))
                count += 1
    return np.array(rays)


def main():
    lines = {name: ["lens,wavelength_nm,x,y,z,dx,dy,dz,ox,oy,oz,ux,uy,uz"] for name in ("optiland", "rayoptics")}
    inputs = {}
    for lens in configurations():
        if lens.name not in inputs:
            inputs[lens.name] = passing_rays(lens)
        rays = inputs[lens.name]
        for name, results in (("optiland", optiland_rays(lens, rays)), ("rayoptics", rayoptics_rays(lens, rays)[0])):
            assert np.isfinite(results).all()
            for row in np.column_stack([rays, results]):
                lines[name].append(",".join([lens.name, str(lens.wavelength)] + [f"{v:.17g}" for v in row]))
    for name, text in lines.items():
        (Path(__file__).parent / f"rays_{name}.csv").write_text("\n".join(text) + "\n", newline="\n")


if __name__ == "__main__":
    main()
