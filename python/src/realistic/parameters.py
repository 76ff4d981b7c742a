"""The parameters of a camera: their names and kinds, and a C structure made from them.

Names, units, ranges and defaults are those of the README's table, everywhere the same.
"""

from __future__ import annotations

import ctypes
import difflib
import math
import operator
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from ._abi import Options, library
from .errors import check

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Parameters(TypedDict, total=False):
    """What a `Camera` takes besides its lens, its resolution and its pose. None: not given."""

    lensfile: str | os.PathLike[str] | None
    """Another name of `specfile`."""
    lens_text: str | bytes | None
    """The text of a lens file, read instead of `specfile`; at most 1 MiB."""
    model: str | None
    """"lens" (default), "thick", "thin", "perspective", "orthographic" or "environment"."""
    glasscatalog: str | os.PathLike[str] | None
    """A glass catalogue (AGF), in which glasses that a lens file names are looked up first."""
    filmdistance: float | None
    """From the last vertex to the film, mm; default the lens file's, or focused at `focusdistance`."""
    focusdistance: float | None
    """From the film plane to the plane in focus, world units, or inf (default); instead of `filmdistance`."""
    focusby: str | None
    """What moves to focus: "film" (default), or "group", the lens's own groups."""
    zoom: str | None
    """Of a zoom lens: a focal length in mm ("35"), or a position's name; default the lens file's first position."""
    aperture_diameter: float | None
    """Clear diameter of the stop, mm; default the lens file's."""
    aperturediameter: float | None
    """Another name of `aperture_diameter`."""
    fnumber: float | None
    """Focal length over entrance pupil diameter; instead of `aperture_diameter`."""
    blades: float | None
    """How many blades the stop has, 3 to 32, or 0 for a round one; default the lens file's, or 0."""
    bladerotation: float | None
    """Where the blades' first corner lies, degrees from image right toward image up; default the lens file's, or 0."""
    bladecurvature: float | None
    """Curvature of the blades' edges over that of the circle, 0 to 1; default the lens file's, or 0."""
    filmdiag: float | None
    """Diagonal of the film, mm; default 35."""
    hither: float | None
    """Where a ray begins, along it, world units; default 1e-3."""
    yon: float | None
    """Where a ray ends, along it, world units; default 1e30."""
    shutteropen: float | None
    """Time at which the shutter opens; default 0."""
    shutterclose: float | None
    """Time at which the shutter closes; default 1."""
    weighting: str | None
    """"radiometric" (default), "assignment", "relative" or "none"."""
    simpleweighting: bool | None
    """pbrt-v3's name for `weighting`: true is "relative", false is "radiometric"."""
    pupil: str | None
    """Where lens samples lie: "warped" (default), "rear" or "disk"."""
    disk: str | None
    """How lens samples map to a disk: "concentric" (default), "polar" or "rejection"."""
    refraction: str | None
    """"fused" (default), "heckbert", "whitted" or "other"."""
    wavelength: float | None
    """From 300 to 2000 nm, for lenses with V-numbers or Sellmeier's constants; default 587.56."""
    mmperunit: float | None
    """Length of a world unit, mm; default 1."""
    precision: str | None
    """"auto" (default), "f64" (or "double") or "f32" (or "single")."""
    tolerance: float | None
    """By how many pixels 99.9 % of the rays may be off, for a faster model of the lens; default 0, exact."""
    shutter: str | None
    """"global" (default), "leaf" or "focal-plane"."""
    shutterramp: float | None
    """Share of the shutter's interval in which a leaf shutter opens, and closes; at most 0.5, default 0.25."""
    shutterslit: float | None
    """Share of it for which a focal-plane shutter exposes each row; at most 1, default 0.25."""
    crop: Iterable[int] | None
    """x from, y from, x to, y to in pixels: the part of the picture to be rendered; it changes no ray."""
    fov: float | None
    """Model "perspective": angle across the shorter side of the image, degrees; default 90."""
    screenwindow: Iterable[float] | None
    """Of the two projections: x from, x to, y from, y to of the part of the screen that becomes the image."""
    frameaspectratio: float | None
    """Of the two projections: width over height of the screen window; default the image's."""
    lensradius: float | None
    """Of the two projections: radius of their thin lens, world units; default 0, a pinhole."""
    focaldistance: float | None
    """Of the two projections: from the eye to the plane of focus, with `lensradius`, world units."""
    lensplane: str | None
    """Of the two projections: where that thin lens lies, "eye" (default) or "hither"."""


ALIASES = {"lensfile": "specfile", "aperturediameter": "aperture_diameter"}
"""Other names of parameters."""

INSTEAD_OF = {
    "specfile": {"lens_text"},
    "lens_text": {"specfile"},
    "filmdistance": {"focusdistance"},
    "focusdistance": {"filmdistance"},
    "aperture_diameter": {"fnumber"},
    "fnumber": {"aperture_diameter"},
    "weighting": {"simpleweighting"},
    "simpleweighting": {"weighting"},
}
"""Parameters that say the same thing as another one, which must not be given with it."""

_KINDS: dict[str, Any] = {field[0]: field[1] for field in Options._fields_}

NAMES = frozenset(Parameters.__annotations__) | {"specfile"}


def canonical(given: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters by their own names; those that are None are left out.

    Raises
    ------
    TypeError
        For a name that no parameter has, and for a parameter given under two names.
    """
    known: dict[str, Any] = {}
    for name, value in given.items():
        if name not in NAMES:
            near = difflib.get_close_matches(name, NAMES, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise TypeError(f"Camera has no parameter {name!r}{hint}")
        if value is None:
            continue
        own = ALIASES.get(name, name)
        if own in known:
            other = next(alias for alias, stands_for in ALIASES.items() if stands_for == own)
            raise TypeError(f"{own!r} and {other!r} are two names of one parameter; give one of them")
        known[own] = value
    return known


def resolution_of(given: Iterable[int]) -> tuple[int, int]:
    """Width and height as two Python integers."""
    try:
        width, height = (operator.index(number) for number in given)
    except (TypeError, ValueError):
        raise TypeError(f"resolution must be two integers (width, height), not {given!r}") from None
    for number in (width, height):
        if not -(2**31) <= number < 2**31:
            raise ValueError(f"resolution ({width}, {height}) is more than the library counts")
    return width, height


def matrix_of(name: str, given: ArrayLike) -> np.ndarray:
    """A pose as a 4x4 matrix of finite float32."""
    matrix = np.asarray(given)
    if matrix.shape != (4, 4) or not np.can_cast(matrix.dtype, np.float32, "same_kind"):
        raise ValueError(
            f"{name} must be a (4, 4) array of real numbers; this one has shape {matrix.shape}, dtype {matrix.dtype}"
        )
    with np.errstate(over="ignore"):
        matrix = matrix.astype(np.float32)
    if not np.isfinite(matrix).all():
        raise ValueError(f"{name} has an element that is not a finite number in single precision")
    return matrix


def options_of(
    parameters: Mapping[str, Any],
    resolution: tuple[int, int],
    pose: Mapping[str, Any],
) -> Options:
    """The C structure of a camera.

    `parameters` are `canonical`, and `pose` has those that are given of camera_to_world, camera_to_world_end (4x4),
    transformstart and transformend (numbers).
    """
    options = Options()
    check(library.realistic_options_init(ctypes.byref(options), ctypes.sizeof(options)))
    options.xres, options.yres = resolution
    for name, value in {**parameters, **pose}.items():
        if name == "lens_text":
            text = value.encode() if isinstance(value, str) else bytes(value)
            options.lens_text, options.lens_text_size = text, len(text)
        elif name in ("camera_to_world", "camera_to_world_end"):
            getattr(options, name)[:] = value.ravel().tolist()
        else:
            setattr(options, name, _converted(name, value))
    return options


def _converted(name: str, value: Any) -> Any:
    """A parameter's value as its field takes it; the field's type says its kind."""
    kind: Any = _KINDS[name]
    if kind is ctypes.c_char_p:
        return _text(name, value)
    if kind is ctypes.c_int32:
        if not isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{name} must be true or false, not {value!r}")
        return int(value)
    if kind is ctypes.c_double:
        return _number(name, value)
    try:
        numbers = [_number(name, number) for number in value]
    except TypeError:
        raise TypeError(f"{name} must be {kind._length_} numbers, not {value!r}") from None
    if len(numbers) != kind._length_:
        raise ValueError(f"{name} must be {kind._length_} numbers, not {len(numbers)}")
    return kind(*numbers)


def _text(name: str, value: Any) -> bytes:
    try:
        # As the file system's names are, so that any file can be named.
        text = os.fsencode(value)
    except TypeError:
        raise TypeError(f"{name} must be text, not {value!r}") from None
    if b"\0" in text:
        raise ValueError(f"{name} has a NUL character in it: {value!r}")
    return text


def _number(name: str, value: Any) -> float:
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        number = float(value)
    except TypeError:
        raise TypeError(f"{name} must be a number, not {value!r}") from None
    if math.isnan(number):
        # To the C ABI it would mean "not given", and pass in silence.
        raise ValueError(f"{name} is NaN; give a number, or leave it out for its default")
    return number
