"""The lenses as models of optiland and of rayoptics.

Both programs let light run toward +z and put the centre of a positive radius on that side; lens space here has +z
toward the scene. So a point or direction (x, y, z) here is (x, y, -z) there, with z measured from the first vertex in
both; radii keep their sign. The reflection changes handedness, which does not affect a rotationally symmetric lens.

Indices are given as fixed numbers, never through the programs' own dispersion formulas.
"""

import warnings
from importlib.metadata import version
from math import inf, isinf, nan

import numpy as np
import optiland.backend as backend
from numba.core.errors import NumbaWarning
from optiland.materials import IdealMaterial
from optiland.optic import Optic
from optiland.rays import RealRays
from rayoptics.environment import OpticalModel
from rayoptics.raytr.opticalspec import FieldSpec, PupilSpec, WvlSpec
from rayoptics.raytr.raytrace import trace as rayoptics_trace
from rayoptics.raytr.traceerror import TraceMissedSurfaceError, TraceRayBlockedError, TraceTIRError

from lenses import Lens

# Numba's warnings about its own compilation.
warnings.filterwarnings("ignore", category=NumbaWarning)

VERSIONS = {name: version(name) for name in ("optiland", "rayoptics")}

# Any plane behind the last vertex will do; its position enters no result.
IMAGE_DISTANCE = 10.0


def optiland_model(lens: Lens) -> Optic:
    backend.set_backend("numpy")
    optic = Optic()
    optic.surfaces.add(index=0, radius=inf, thickness=inf)
    for k, row in enumerate(lens.rows):
        last = k == len(lens.rows) - 1
        optic.surfaces.add(index=k + 1, radius=row.radius, thickness=IMAGE_DISTANCE if last else row.thickness,
                           material=IdealMaterial(row.index), is_stop=k == lens.stop)
    optic.surfaces.add(index=len(lens.rows) + 1, radius=inf)
    optic.set_aperture("float_by_stop_size", lens.rows[lens.stop].diameter)
    optic.fields.set_type("angle")
    optic.fields.add(y=0)
    optic.wavelengths.add(value=lens.wavelength * 1e-3, is_primary=True)
    return optic


def rayoptics_model(lens: Lens, object_distance: float) -> OpticalModel:
    model = OpticalModel()
    sequence, spec = model["seq_model"], model["optical_spec"]
    model.radius_mode = True
    spec["pupil"] = PupilSpec(spec, key=["object", "epd"], value=1.0)
    spec["fov"] = FieldSpec(spec, key=["object", "angle"], flds=[0.0, 1.0])
    spec["wvls"] = WvlSpec([(lens.wavelength, 1.0)], ref_wl=0)
    sequence.gaps[0].thi = object_distance
    for k, row in enumerate(lens.rows):
        last = k == len(lens.rows) - 1
        sequence.add_surface([0.0 if isinf(row.radius) else row.radius,
                              IMAGE_DISTANCE if last else row.thickness, row.index, "", row.diameter / 2])
        if k == lens.stop:
            sequence.set_stop()
    # The diameters are those of the prescription; the model must not compute its own.
    sequence.do_apertures = False
    model.update_model()
    return model


def optiland_rays(lens: Lens, rays: np.ndarray) -> np.ndarray:
    """Traces rays given as rows x,y,z,dx,dy,dz in lens space; returns the rows at the rear interface in the same
    form."""
    optic = optiland_model(lens)
    x, y, z, dx, dy, dz = (np.ascontiguousarray(c) for c in rays.T)
    count = len(rays)
    bundle = RealRays(x, y, -z, dx, dy, -dz, np.ones(count), np.full(count, lens.wavelength * 1e-3))
    optic.surfaces.trace(bundle)
    group, rear = optic.surfaces, len(lens.rows)
    return np.column_stack([group.x[rear], group.y[rear], -group.z[rear],
                            group.L[rear], group.M[rear], -group.N[rear]])


def rayoptics_rays(lens: Lens, rays: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Traces as optiland_rays does, and returns the program's own verdict on each ray in truth.py's words; blocked rays
    give NaN."""
    sequence = rayoptics_model(lens, object_distance=1.0)["seq_model"]
    # Rays are given in the object plane's frame; if the plane is at the first vertex, nothing is lost in the shift. It
    # cannot be there from the beginning: the program's paraxial part refuses an object in the entrance pupil.
    sequence.gaps[0].thi = 0.0
    sequence.update_model()
    rear_vertex = -sum(row.thickness for row in lens.rows[:-1])
    found, verdicts = [], []
    for x, y, z, dx, dy, dz in rays:
        try:
            # Rays that turn back can make the program divide by zero before it refuses them.
            with np.errstate(all="ignore"):
                path, _, _ = rayoptics_trace(sequence, np.array([x, y, -z]), np.array([dx, dy, -dz]),
                                             lens.wavelength, intersect_obj=False, check_apertures=True,
                                             pt_inside_fuzz=0.0)
        except (TraceMissedSurfaceError, TraceTIRError, TraceRayBlockedError) as error:
            found.append([nan] * 6)
            verdicts.append({TraceMissedSurfaceError: "missed", TraceTIRError: "reflected",
                             TraceRayBlockedError: "clipped"}[type(error)])
            continue
        (px, py, pz), (ux, uy, uz) = path[len(lens.rows)][:2]
        found.append([px, py, rear_vertex - pz, ux, uy, -uz])
        verdicts.append("ok")
    return np.array(found), verdicts
