"""First-order data of the lenses by optiland and by rayoptics; writes first_order.csv."""

from pathlib import Path

import numpy as np

from lenses import REAL_LENSES, Lens, configurations
from programs import IMAGE_DISTANCE, VERSIONS, optiland_model, rayoptics_model

HEADER = """\
# First-order data at fixed indices; lengths in millimetres, f_number without unit (in the same column).
# Signs: positions along the way of the light from the scene to the film, POSITIVE TOWARD THE FILM (lens space has
# +z toward the scene, so a position p from the first vertex is z = -p there; one from the last vertex is
# z = z_last - p, z_last being minus the sum of all thicknesses but the last row's).
#   focal_length             positive for a converging lens
#   back_focal_distance      last vertex -> rear focal point (positive: on the film's side of the lens)
#   front_focal_distance     first vertex -> front focal point (negative: on the scene's side of the lens)
#   front_principal_plane    first vertex -> front (object-side) principal plane
#   rear_principal_plane     last vertex -> rear (film-side) principal plane
#   entrance_pupil_position  first vertex -> paraxial image of the stop row in scene space
#   exit_pupil_position      last vertex -> paraxial image of the stop row in film space
#   *_pupil_diameter         paraxial image of the stop row's clear diameter, whatever other apertures may cut off
#   f_number                 focal_length / entrance_pupil_diameter
"""
QUANTITIES = ("focal_length", "back_focal_distance", "front_focal_distance", "front_principal_plane",
              "rear_principal_plane", "entrance_pupil_position", "entrance_pupil_diameter", "exit_pupil_position",
              "exit_pupil_diameter", "f_number")


def by_optiland(lens: Lens) -> tuple[float, ...]:
    parax = optiland_model(lens).paraxial
    # The program measures the image side from the image plane.
    return tuple(np.asarray(v).item() for v in (
        parax.f2(), parax.F2() + IMAGE_DISTANCE, parax.F1(), parax.P1(), parax.P2() + IMAGE_DISTANCE,
        parax.EPL(), parax.EPD(), parax.XPL() + IMAGE_DISTANCE, parax.XPD(), parax.FNO()))


def by_rayoptics(lens: Lens) -> tuple[float, ...]:
    # None of this depends on the position of the object; but with its customary infinity of 1e10 mm, the program
    # computes the pupils to six digits only.
    data = rayoptics_model(lens, object_distance=1000.0)["analysis_results"]["parax_data"]
    fod = data.fod
    # The program takes the diameter of an entrance pupil, not of a stop: scale the result for a pupil of 1 mm.
    scale = lens.rows[lens.stop].diameter / 2 / abs(data.ax_ray[lens.stop + 1][0])
    entrance = 2 * fod.enp_radius * scale
    # The program's own exp_dist presumes an image plane at the paraxial image; the plane here is arbitrary.
    height, slope = data.pr_ray[-1][:2]
    exit_position = IMAGE_DISTANCE - height / slope
    return tuple(float(v) for v in (
        fod.efl, fod.bfl, fod.ffl, fod.pp1, fod.ppk, fod.enp_dist, entrance, exit_position, 2 * fod.exp_radius * scale,
        fod.efl / entrance))


def main():
    lines = [HEADER + "lens,wavelength_nm,program,version,quantity,value_mm"]
    for lens in configurations():
        if lens.name not in REAL_LENSES:
            continue
        for program, compute in (("optiland", by_optiland), ("rayoptics", by_rayoptics)):
            lines += [f"{lens.name},{lens.wavelength},{program},{VERSIONS[program]},{quantity},{value:.17g}"
                      for quantity, value in zip(QUANTITIES, compute(lens), strict=True)]
    (Path(__file__).parent / "first_order.csv").write_text("\n".join(lines) + "\n", newline="\n")


if __name__ == "__main__":
    main()
