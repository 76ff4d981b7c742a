"""Lists the lenses of collections: returns the output of `realistic lenses` as a table."""

from __future__ import annotations

import json
import os
import subprocess
from typing import TypedDict

from ._program import program
from .errors import Error


class LensRow(TypedDict):
    """A lens of a collection, or a file that cannot be read. None is a value that is unknown.

    Attributes
    ----------
    lens_file: the name of the lens for `Camera` and `Lens`
    name: its path in the collection
    title: its title, as the file states it
    maker: the maker's name in the title, or else in the path
    year: the year of the patent or book, as the file states it
    focal_length_mm: focal length, mm; None for an afocal lens
    is_zoom: whether it is a zoom lens
    shortest_focal_length_mm: of a zoom lens, mm
    longest_focal_length_mm: of a zoom lens, mm
    fnumber: f-number of the axial beam of exact rays
    widest_field_of_view_deg: full field of view as the file states it, degrees; the widest of a zoom lens
    is_symmetric: whether the lens is symmetric about its axis
    interfaces: number of interfaces
    error: the reason why the file cannot be read; None for a lens
    """

    lens_file: str
    name: str
    title: str | None
    maker: str | None
    year: int | None
    focal_length_mm: float | None
    is_zoom: bool | None
    shortest_focal_length_mm: float | None
    longest_focal_length_mm: float | None
    fnumber: float | None
    widest_field_of_view_deg: float | None
    is_symmetric: bool | None
    interfaces: int | None
    error: str | None


def lenses(path: str | os.PathLike[str] | None = None) -> list[LensRow]:
    """Lists the lenses of a folder, a zip archive or a file, as rows that `pandas.DataFrame` takes.

    Without a path, the collections that the variable REALISTIC_LENSES names are listed, or else the catalogue. Lengths
    are in mm. Files that cannot be read have a row with an `error`; files that are no lenses have none.

    >>> fast = [row for row in lenses() if row["fnumber"] is not None and row["fnumber"] < 1.5]
    >>> fast[0]["lens_file"], round(fast[0]["focal_length_mm"])
    ('biotar.100mm', 100)

    Raises
    ------
    Error
        If nothing is at the path.
    FileNotFoundError
        If the program `realistic` is not found.
    """
    command = [str(program()), "lenses", "--json", "--quiet"]
    if path is not None:
        command += ["--", os.fspath(path)]
    completed = subprocess.run(command, capture_output=True, check=False)
    if completed.returncode != 0:
        message = completed.stderr.decode(errors="replace").strip()
        raise Error(message.removeprefix("realistic: error: ") or f"{command[0]} failed")
    rows: list[LensRow] = json.loads(completed.stdout)
    return rows
