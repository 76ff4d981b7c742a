"""Exports a camera's lens to the formats of other programs: returns the output of `realistic export` as arrays."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ._program import report

_MAPS = ("st-map", "rays", "illumination")


def export(
    parameters: Mapping[str, Any], resolution: tuple[int, int], film_diagonal: float, model: str
) -> dict[str, Any]:
    """Returns the report of `realistic export --as model --json`, with its lists as arrays, and adds the maps or the
    text that the program writes to a file."""
    given = {**parameters, "film_diagonal": film_diagonal}
    if (of := given.pop("model", "lens")) != "lens":
        raise ValueError(f'only a camera of model "lens" has a lens to export, and this one is of "{of}"')
    size = f"{resolution[0]}x{resolution[1]}"
    with tempfile.TemporaryDirectory(prefix="realistic-") as folder:
        out = Path(folder) / ("out.npy" if model in _MAPS else "out.txt")
        words = ["export", "--as", model, "--size", size, "--out", str(out)]
        found: dict[str, Any] = _arrays(report(words, given))
        if model == "st-map":
            del found["files"]
            for mapping in ("undistort", "distort"):
                found[mapping] = np.load(out.with_suffix(f".{mapping}.npy"))
        elif model == "rays":
            found.pop("files", None)
            rays = np.load(out)
            found["origin"], found["direction"] = rays[..., :3], rays[..., 3:]
        elif model == "illumination":
            found["map"] = np.load(out)[..., 0]
        else:
            found["text"] = out.read_text()
    return found


def _arrays(value: Any) -> Any:
    """Converts lists of numbers to arrays, at every level of nesting."""
    if isinstance(value, dict):
        return {name: _arrays(each) for name, each in value.items()}
    if isinstance(value, list):
        if value and all(isinstance(each, (int, float)) for each in value):
            return np.asarray(value)
        return [_arrays(each) for each in value]
    return value
