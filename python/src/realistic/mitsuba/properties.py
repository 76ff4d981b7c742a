"""The properties of a sensor in a Mitsuba scene: a camera's parameters, two of them under Mitsuba's own names."""

from __future__ import annotations

import difflib
from typing import Any

import mitsuba as mi

from ..parameters import NAMES

_OF_MITSUBA = {"shutter_open", "shutter_close"}
"""Parameters that Mitsuba's own properties of the same name set."""

_PROJECTIONS = {"fov", "screen_window", "frame_aspect_ratio", "lens_radius", "focal_distance", "lens_plane"}
"""Parameters of models for which Mitsuba has sensors of its own."""

MODELS = ("lens", "thick", "thin")
"""The models that this package offers as sensors."""

OWN = ("differentials", "dispersion_tolerance")
"""Properties of the sensor that are not parameters of the camera."""

_NAMES = {name: name for name in NAMES - _OF_MITSUBA - _PROJECTIONS} | {"near_clip": "hither", "far_clip": "yon"}
"""The camera's parameter for each property."""


def parameters_of(props: Any, model: str | None) -> tuple[dict[str, Any], dict[str, Any]]:
    """Returns the camera's parameters from a sensor's properties, and the sensor's own ones.

    `model` is the model that the sensor's name implies, if any.

    Raises
    ------
    ValueError
        For an unknown property, and one given twice.
    """
    parameters: dict[str, Any] = {} if model is None else {"model": model}
    own: dict[str, Any] = {}
    for key in props.unqueried():
        value = props[key]
        if key == "to_world_end":
            continue
        if key in OWN:
            if key == "differentials" and not isinstance(value, bool):
                raise ValueError(f'property "{key}" must be true or false, not {value!r}')
            if key == "dispersion_tolerance" and (not _pixels(value)):
                raise ValueError(f'property "{key}" must be a number of pixels, 0 or more, not {value!r}')
            own[key] = value
            continue
        name = _NAMES.get(key)
        if name is None:
            raise ValueError(_unknown(key))
        if name in parameters:
            if name == "model":
                raise ValueError(f'property "{key}" is not one of a sensor "{model}", which is one already')
            raise ValueError(f'property "{key}" is given twice, under another name')
        parameters[name] = _value(name, value)
    if parameters.get("model", "lens") not in MODELS:
        raise ValueError(
            f'model "{parameters["model"]}" is no sensor here: give one of {", ".join(MODELS)}, or use Mitsuba\'s own '
            "sensors perspective, orthographic and so on"
        )
    return parameters, own


def _pixels(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value >= 0


def _unknown(key: str) -> str:
    if key in _PROJECTIONS:
        return f'property "{key}" is for cameras without a real lens: use Mitsuba\'s own sensors'
    similar = difflib.get_close_matches(key, [*_NAMES, *_OF_MITSUBA, *OWN], 1)
    hint = f'; did you mean "{similar[0]}"?' if similar else ""
    return f'there is no property "{key}"{hint}'


def _value(name: str, value: Any) -> Any:
    if name in ("lens_file", "glass_catalog") and isinstance(value, str):
        # A file is found beside the scene's file, like other files of the scene. A name of the catalogue stays
        # unchanged.
        return str(mi.file_resolver().resolve(value))
    if name == "zoom" and isinstance(value, (int, float)) and not isinstance(value, bool):
        return repr(value)
    return value
