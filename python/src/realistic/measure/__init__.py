"""Measures of a lens, computed from its camera's rays, as arrays: illumination, spots, MTF, distortion, ray fans, field
curvature.

Points of the picture are given either as a `Field` (in pixels, fractions or field angles) or as an array of raster
positions in pixels, like `image_xy` of `Camera.rays`. Measures are geometric optics, without diffraction;
`diffraction_mtf` and `airy_radius` are the diffraction limit.
"""

from .diffraction import airy_radius, diffraction_mtf, working_fnumber
from .fans import Fans, fans, field_curvature
from .field import distortion, relative_illumination
from .intrinsics import Intrinsics, intrinsics
from .points import Field, field_angle
from .spots import Spots, mtf, spots

__all__ = [
    "Fans",
    "Field",
    "Intrinsics",
    "Spots",
    "airy_radius",
    "diffraction_mtf",
    "distortion",
    "fans",
    "field_angle",
    "field_curvature",
    "intrinsics",
    "mtf",
    "relative_illumination",
    "spots",
    "working_fnumber",
]
