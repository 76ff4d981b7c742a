"""Declares the C ABI (`include/realistic.h`) for ctypes: structures, functions and constants; finds and loads the
library.

All other modules call the library through this module's `library`. ctypes releases the global interpreter lock during a
call. `tests/test_header.py` compares this module with the header.
"""

from __future__ import annotations

import ctypes
import os
import sys
from ctypes import POINTER, c_char_p, c_double, c_float, c_int32, c_size_t, c_ssize_t, c_uint32, c_void_p
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._parameters import MEMBERS

if TYPE_CHECKING:
    from collections.abc import Callable

ABI_VERSION = 1
"""Oldest version of the C ABI that this package works with."""

LOG = ctypes.CFUNCTYPE(None, c_void_p, c_int32, c_char_p)
"""`realistic_log`: the type of a callback for messages."""


class Options(ctypes.Structure):
    """`realistic_options`: the options for building a camera."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("xres", c_int32),
        ("yres", c_int32),
        ("camera_to_world", c_float * 16),
        ("camera_to_world_end", c_float * 16),
        ("transform_start", c_double),
        ("transform_end", c_double),
        ("log", LOG),
        ("log_user", c_void_p),
        ("lens_text", c_char_p),
        ("lens_text_size", c_size_t),
        ("donor", c_void_p),
        *MEMBERS,
    ]


class CameraInfo(ctypes.Structure):
    """`realistic_camera_info`: the properties of a built camera."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("interfaces", c_uint32),
        ("focal_length_mm", c_double),
        ("fnumber", c_double),
        ("film_distance", c_double),
        ("focus_distance_mm", c_double),
        ("film_diagonal", c_double),
        ("crop", c_uint32 * 4),
    ]


class Ray(ctypes.Structure):
    """`realistic_ray`: one ray in world space."""

    _fields_ = [("o", c_float * 3), ("d", c_float * 3), ("mint", c_float), ("maxt", c_float), ("time", c_float)]


class Zone(ctypes.Structure):
    """`realistic_zone`: a rectangle of the picture in pixels."""

    _fields_ = [("left", c_float), ("top", c_float), ("right", c_float), ("bottom", c_float)]


class LensInfo(ctypes.Structure):
    """`realistic_lens_info`: the first-order properties of a lens."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("surfaces", c_uint32),
        ("stop", c_int32),
        ("limiting", c_int32),
        ("wavelength", c_double),
        ("focal_length_mm", c_double),
        ("fnumber", c_double),
        ("back_focal_distance_mm", c_double),
        ("front_focal_point_mm", c_double),
        ("rear_focal_point_mm", c_double),
        ("front_principal_plane_mm", c_double),
        ("rear_principal_plane_mm", c_double),
        ("rear_vertex_mm", c_double),
        ("entrance_pupil_mm", c_double),
        ("entrance_pupil_diameter_mm", c_double),
        ("exit_pupil_mm", c_double),
        ("exit_pupil_diameter_mm", c_double),
        ("stated_focal_length_mm", c_double),
        ("nominal_film_distance_mm", c_double),
        ("tnumber_bare", c_double),
        ("tnumber_quarter_wave", c_double),
        ("fnumber_paraxial", c_double),
        ("index_scene", c_double),
        ("index_film", c_double),
        ("front_nodal_point_mm", c_double),
        ("rear_nodal_point_mm", c_double),
        ("focal_length_x_mm", c_double),
        ("back_focal_distance_x_mm", c_double),
        ("is_centred", c_uint32),
        ("mirrors", c_uint32),
        ("fnumber_x", c_double),
        ("entrance_pupil_x_mm", c_double),
        ("entrance_pupil_diameter_x_mm", c_double),
        ("exit_pupil_x_mm", c_double),
        ("exit_pupil_diameter_x_mm", c_double),
    ]


class LensSurface(ctypes.Structure):
    """`realistic_lens_surface`: one surface of a lens."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("is_stop", c_uint32),
        ("vertex_mm", c_double),
        ("radius_mm", c_double),
        ("thickness_mm", c_double),
        ("index_scene", c_double),
        ("index_film", c_double),
        ("semi_diameter_mm", c_double),
        ("conic_radius_mm", c_double),
        ("conic", c_double),
        ("aspheric", c_double * 30),
        ("radius_x_mm", c_double),
        ("is_mirror", c_uint32),
        ("is_turned", c_uint32),
    ]


class FocusedFilm(ctypes.Structure):
    """`realistic_focused_film`: the distance and tilt of the film that is in focus on a plane."""

    _fields_ = [
        ("struct_size", c_uint32),
        *[(name, c_double) for name in ("film_distance", "film_tilt_x", "film_tilt_y")],
    ]


_VIEW: list[tuple[str, Any]] = [*[(name, c_void_p) for name in ("x", "y", "z")], ("stride", c_ssize_t)]


class Input(ctypes.Structure):
    """`realistic_input`: numbers, pairs or vectors of float32 that the library reads."""

    _fields_ = _VIEW


class Output(ctypes.Structure):
    """`realistic_output`: memory to which the library writes numbers, pairs or vectors of float32."""

    _fields_ = _VIEW


class Vectors(ctypes.Structure):
    """`realistic_vectors`: vectors of float64 that the library writes, and for rays also reads."""

    _fields_ = _VIEW


class LensRaysView(ctypes.Structure):
    """`realistic_lens_rays`: rays in lens space."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("origin", Vectors),
        ("direction", Vectors),
        ("reason", c_void_p),
        ("reason_stride", c_ssize_t),
        ("optical_path", c_void_p),
        ("optical_path_stride", c_ssize_t),
    ]


class LensPointsView(ctypes.Structure):
    """`realistic_lens_points`: the points where rays meet surfaces."""

    _fields_ = [("struct_size", c_uint32), ("point", Vectors), ("met", c_void_p), ("met_stride", c_ssize_t)]


class Request(ctypes.Structure):
    """`realistic_request`: samples and the memory for their rays. Pointers of omitted columns are NULL."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("wavelengths_per_sample", c_uint32),
        *[(name, Input) for name in ("image", "lens", "time", "wavelength")],
        *[(name, Output) for name in ("origin", "direction", "weight", "mint", "maxt", "ray_time")],
        ("reason", c_void_p),
        ("reason_stride", c_ssize_t),
        *[
            (name, Output)
            for name in ("rx_origin", "rx_direction", "rx_weight", "ry_origin", "ry_direction", "ry_weight")
        ],
    ]


class ImportanceRaysView(ctypes.Structure):
    """`realistic_importance_rays`: rays that enter a camera."""

    _fields_ = [("struct_size", c_uint32), *[(name, Input) for name in ("origin", "direction", "time")]]


class ImportanceView(ctypes.Structure):
    """`realistic_importance`: the importance of rays."""

    _fields_ = [
        ("struct_size", c_uint32),
        *[(name, Output) for name in ("image", "importance", "density", "area_density", "solid_angle_density")],
    ]


class ScenePointsView(ctypes.Structure):
    """`realistic_scene_points`: scene points from which to sample directions toward the lens."""

    _fields_ = [("struct_size", c_uint32), *[(name, Input) for name in ("point", "lens", "time")]]


class AimedView(ctypes.Structure):
    """`realistic_aimed`: directions toward the lens."""

    _fields_ = [("struct_size", c_uint32), *[(name, Output) for name in ("origin", "direction", "density")]]


DISTANCE = ctypes.CFUNCTYPE(c_double, c_void_p, POINTER(Ray))
"""`realistic_distance`: the type of a callback that measures a distance along a ray."""

CONTRAST = ctypes.CFUNCTYPE(c_double, c_void_p, c_void_p, POINTER(Zone))
"""`realistic_contrast`: the type of a callback that measures the contrast in a zone."""

_STATUS = c_int32

FUNCTIONS = {
    "realistic_abi_version": (c_uint32, []),
    "realistic_version": (c_char_p, []),
    "realistic_last_error": (c_char_p, []),
    "realistic_options_init": (_STATUS, [POINTER(Options), c_uint32]),
    "realistic_camera_new": (_STATUS, [POINTER(Options), POINTER(c_void_p)]),
    "realistic_camera_free": (None, [c_void_p]),
    "realistic_camera_get_info": (_STATUS, [c_void_p, POINTER(CameraInfo)]),
    "realistic_camera_get_lens_name": (_STATUS, [c_void_p, c_char_p, c_size_t, POINTER(c_size_t)]),
    "realistic_camera_plan": (_STATUS, [c_void_p, c_char_p, c_size_t, POINTER(c_size_t)]),
    "realistic_camera_generate_batch": (_STATUS, [c_void_p, c_size_t, POINTER(Request)]),
    "realistic_camera_importance": (
        _STATUS,
        [c_void_p, c_size_t, POINTER(ImportanceRaysView), POINTER(ImportanceView)],
    ),
    "realistic_camera_sample_importance": (
        _STATUS,
        [c_void_p, c_size_t, POINTER(ScenePointsView), POINTER(AimedView), POINTER(ImportanceView)],
    ),
    "realistic_catalogue": (_STATUS, [c_char_p, c_size_t, POINTER(c_size_t)]),
    "realistic_lens_new": (_STATUS, [POINTER(Options), POINTER(c_void_p)]),
    "realistic_lens_free": (None, [c_void_p]),
    "realistic_lens_get_info": (_STATUS, [c_void_p, POINTER(LensInfo)]),
    "realistic_lens_get_surface": (_STATUS, [c_void_p, c_uint32, POINTER(LensSurface)]),
    "realistic_lens_get_name": (_STATUS, [c_void_p, c_char_p, c_size_t, POINTER(c_size_t)]),
    "realistic_lens_focus": (_STATUS, [c_void_p, c_double, POINTER(c_double)]),
    "realistic_lens_focused_on": (_STATUS, [c_void_p, c_double, POINTER(c_double)]),
    "realistic_lens_plane_of_focus": (_STATUS, [c_void_p, POINTER(c_double), POINTER(FocusedFilm)]),
    "realistic_lens_trace": (
        _STATUS,
        [c_void_p, c_int32, c_size_t, POINTER(LensRaysView), POINTER(LensPointsView)],
    ),
    "realistic_autofocus": (
        _STATUS,
        [POINTER(Options), POINTER(Zone), c_size_t, c_int32, DISTANCE, CONTRAST, c_void_p, POINTER(c_double)],
    ),
}
"""Result and argument types of the functions that this package calls."""


def library_file() -> Path:
    """Returns the library's path: the file that the variable REALISTIC_PLUGIN names, else the one in this package."""
    named = os.environ.get("REALISTIC_PLUGIN")
    if named:
        return Path(named)
    name = {"darwin": "librealistic.dylib", "win32": "realistic.dll"}.get(sys.platform, "librealistic.so")
    return Path(__file__).parent / name


def _load() -> ctypes.CDLL:
    file = library_file()
    if not file.exists():
        raise ImportError(
            f"realistic's library is not at {file}: install the package (`pip install ./python` in a checkout), or "
            "name a built library in the variable REALISTIC_PLUGIN"
        )
    try:
        loaded = ctypes.CDLL(str(file))
        for name, (result, arguments) in FUNCTIONS.items():
            function = getattr(loaded, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise ImportError(f"{file} is not a library that this package can use: {error}") from error
    version = loaded.realistic_abi_version()
    if version < ABI_VERSION:
        raise ImportError(f"{file} has version {version} of the C ABI; this package needs {ABI_VERSION} or later")
    return loaded


library = _load()


def version() -> str:
    """Returns the library's version, such as "0.1.0"."""
    return str(library.realistic_version().decode())


def text_of(function: Callable[..., int], *arguments: Any) -> tuple[int, str]:
    """Calls a function that copies text into a buffer; returns its status and the text."""
    length = c_size_t()
    status = function(*arguments, None, 0, ctypes.byref(length))
    buffer = ctypes.create_string_buffer(length.value + 1)
    if status == 0:
        status = function(*arguments, buffer, len(buffer), None)
    return status, buffer.value.decode()
