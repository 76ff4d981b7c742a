"""Lenses as cameras for Blender's Cycles: self-contained shaders in Open Shading Language, written by the program
`realistic`."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from .._program import program
from ..errors import Error

__all__ = ["program", "write_shader"]


def write_shader(
    lens: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    dispersion: bool = False,
    film_diagonal: float | None = None,
    zoom: float | str | None = None,
) -> Path:
    """Writes the shader of a lens (a file, or a name of the catalogue) and returns its path.

    dispersion: whether each sample has a wavelength of its own. film_diagonal: diagonal of the largest sensor, shifts
    included; film beyond it stays black. zoom: focal length in mm, or name of a zoom position, at which to fix a zoom
    lens; by default the shader covers the whole zoom range.

    Raises FileNotFoundError if the program is not found, and Error with the program's message if it fails.
    """
    command = [str(program()), "blender", os.fspath(lens), "--out", os.fspath(out)]
    if dispersion:
        command.append("--dispersion")
    if film_diagonal is not None:
        command += ["--film-diagonal", repr(float(film_diagonal))]
    if zoom is not None:
        command += ["--zoom", str(zoom)]
    completed = subprocess.run(command, capture_output=True, text=True, check=False)
    if completed.returncode != 0:
        raise Error(completed.stderr.strip().removeprefix("realistic: error: ") or f"{command[0]} failed")
    return Path(out)
