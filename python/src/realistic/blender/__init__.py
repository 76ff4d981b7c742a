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
    film_diagonal_mm: float | None = None,
    zoom: float | str | None = None,
) -> Path:
    """Writes the shader of a lens (a file, or a name of the catalogue) and gives its path.

    dispersion: a wavelength of its own for each sample. film_diagonal_mm: of the largest sensor, shifts included; film
    beyond it stays black. zoom: a focal length in mm or a position's name, to which a zoom lens
    is fixed; else the shader has its whole range.

    Raises FileNotFoundError where there is no program, and Error with the program's words where it refuses.
    """
    command = [str(program()), "blender", os.fspath(lens), "--out", os.fspath(out)]
    if dispersion:
        command.append("--dispersion")
    if film_diagonal_mm is not None:
        command += ["--filmdiag", repr(float(film_diagonal_mm))]
    if zoom is not None:
        command += ["--zoom", str(zoom)]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    if told.returncode != 0:
        raise Error(told.stderr.strip().removeprefix("realistic: error: ") or f"{command[0]} failed")
    return Path(out)
