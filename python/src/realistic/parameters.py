"""The parameters of a camera by name, and a C structure made from them.

Names, units, ranges and defaults are those of the library's table, from which `_parameters.py` is generated.
"""

from __future__ import annotations

import ctypes
import difflib
import math
import operator
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._abi import Options, library
from ._parameters import Parameters
from .errors import check

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


INSTEAD_OF = {
    "lens_file": {"lens_text"},
    "lens_text": {"lens_file"},
    "film_distance": {"focus_distance"},
    "focus_distance": {"film_distance"},
    "aperture_diameter": {"fnumber"},
    "fnumber": {"aperture_diameter"},
    "weighting": {"simple_weighting"},
    "simple_weighting": {"weighting"},
}
"""Alternatives of parameters: two ways to set the same quantity, of which only one may be given."""

_KINDS: dict[str, Any] = {name: kind for name, kind, *_ in Options._fields_}

NAMES = frozenset(Parameters.__annotations__) | {"lens_file"}


def checked(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the parameters that are not None.

    Raises
    ------
    TypeError
        For an unknown name.
    """
    for name in parameters:
        if name not in NAMES:
            similar = difflib.get_close_matches(name, NAMES, 1)
            hint = f"; did you mean {similar[0]!r}?" if similar else ""
            raise TypeError(f"Camera has no parameter {name!r}{hint}")
    return {name: value for name, value in parameters.items() if value is not None}


def mm_per_unit_of(parameters: Mapping[str, Any]) -> float:
    """Returns the length of a world unit, mm, for parameters that are not None."""
    return float(parameters.get("mm_per_unit", 1.0))


def focuses_by_film(parameters: Mapping[str, Any]) -> bool:
    """Whether cameras with these parameters, which are not None, trace a lens and focus by the position of their film."""
    return parameters.get("model", "lens") == "lens" and parameters.get("focus_by", "film") == "film"


def resolution_of(given: Iterable[int]) -> tuple[int, int]:
    """Returns width and height as two Python integers."""
    try:
        width, height = (operator.index(number) for number in given)
    except (TypeError, ValueError):
        raise TypeError(f"resolution must be two integers (width, height), not {given!r}") from None
    for number in (width, height):
        if not -(2**31) <= number < 2**31:
            raise ValueError(f"resolution ({width}, {height}) is more than the library counts")
    return width, height


def matrix_of(name: str, given: ArrayLike) -> np.ndarray:
    """Returns a pose as a 4x4 matrix of finite float32."""
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
    """Returns the C structure of a camera.

    `parameters` are those from `checked`. `pose` may hold camera_to_world and camera_to_world_end (4x4), and
    transform_start and transform_end (numbers).
    """
    options = Options()
    check(library.realistic_options_init(ctypes.byref(options), ctypes.sizeof(options)))
    options.xres, options.yres = resolution
    for name, value in {**parameters, **pose}.items():
        if name == "lens_text":
            if not isinstance(value, (str, bytes)):
                raise TypeError(f"lens_text must be the text of a lens file, str or bytes, and not {value!r}")
            text = value.encode() if isinstance(value, str) else value
            options.lens_text, options.lens_text_size = text, len(text)
        elif name in ("camera_to_world", "camera_to_world_end"):
            getattr(options, name)[:] = value.ravel().tolist()
        else:
            setattr(options, name, _converted(name, value))
    return options


def _converted(name: str, value: Any) -> Any:
    """Converts a parameter's value to the type of its field."""
    kind: Any = _KINDS[name]
    if name == "zoom" and isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        # The C ABI takes a zoom setting as text, because it may be the name of a position.
        return repr(_number(name, value)).encode()
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
        # Text is encoded like the file system's names, so that any file can be named.
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
        # The C ABI would silently take NaN as "not given".
        raise ValueError(f"{name} is NaN; give a number, or leave it out for its default")
    return number
