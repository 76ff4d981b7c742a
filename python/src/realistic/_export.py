"""Exports a camera's lens to the formats of other programs: returns the output of `realistic export` as arrays."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ._program import program
from .errors import Error

_MAPS = ("st-map", "rays", "illumination")


def _text(value: Any) -> str:
    """Formats a parameter's value for the command line."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, (tuple, list, np.ndarray)):
        return ",".join(repr(float(each)) for each in value)
    return repr(float(value))


def export(
    parameters: Mapping[str, Any], resolution: tuple[int, int], film_diagonal: float, model: str
) -> dict[str, Any]:
    """Returns the report of `realistic export --as model --json`, with its lists as arrays, and adds the maps or the
    text that the program writes to a file."""
    given = {"lens_file": "dgauss.50mm", **parameters, "film_diagonal": film_diagonal}
    if (of := given.pop("model", "lens")) != "lens":
        raise ValueError(f'only a camera of model "lens" has a lens to export, and this one is of "{of}"')
    lens_text = given.pop("lens_text", None)
    if lens_text is not None:
        given["lens_file"] = "-"
    words = [f"--param={name}={_text(value)}" for name, value in given.items() if value is not None]
    size = f"{resolution[0]}x{resolution[1]}"
    with tempfile.TemporaryDirectory(prefix="realistic-") as folder:
        out = Path(folder) / ("out.npy" if model in _MAPS else "out.txt")
        command = [str(program()), "export", "--as", model, "--json", "--quiet", "--size", size, "--out", str(out)]
        text = lens_text.encode() if isinstance(lens_text, str) else lens_text
        completed = subprocess.run([*command, *words], input=text or b"", capture_output=True, check=False)
        if completed.returncode != 0:
            message = completed.stderr.decode(errors="replace").strip()
            raise Error(message.removeprefix("realistic: error: ") or f"{command[0]} failed")
        found: dict[str, Any] = _arrays(json.loads(completed.stdout))
        if model == "st-map":
            del found["files"]
            for mapping in ("undistort", "distort"):
                found[mapping] = np.load(out.with_suffix(f".{mapping}.npy"))
        elif model == "rays":
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
