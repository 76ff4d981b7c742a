"""Cameras with real lenses for renderers, with an interface of NumPy arrays.

>>> import numpy as np, realistic
>>> camera = realistic.Camera("dgauss.50mm", resolution=(1920, 1280), focus_distance=1000.0)
>>> rng = np.random.default_rng(0)
>>> rays = camera.rays(rng.random((1000, 2)) * camera.resolution, rng.random((1000, 2)))
>>> rays.origin.shape, rays.direction.shape, rays.weight.shape
((1000, 3), (1000, 3), (1000,))
"""

from . import farm, measure
from ._abi import version
from ._ghosts import Ghost
from ._lenses import LensRow, lenses
from ._parameters import Parameters
from ._waves import Psf, Wavefront, WaveMtf
from .camera import Camera
from .errors import (
    CameraWarning,
    DefectError,
    Error,
    FocusError,
    LensFileError,
    OutOfMemoryError,
    ParameterError,
)
from .farm import Table, study
from .lens import Lens, LensRays, Pupils, catalogue
from .measure import Field, Intrinsics
from .rays import Rays, Reason
from .surfaces import Surface

__version__ = version()

__all__ = [
    "Camera",
    "CameraWarning",
    "DefectError",
    "Error",
    "Field",
    "FocusError",
    "Ghost",
    "Intrinsics",
    "Lens",
    "LensFileError",
    "LensRays",
    "LensRow",
    "OutOfMemoryError",
    "ParameterError",
    "Parameters",
    "Psf",
    "Pupils",
    "Rays",
    "Reason",
    "Surface",
    "Table",
    "WaveMtf",
    "Wavefront",
    "catalogue",
    "farm",
    "lenses",
    "measure",
    "study",
]
