"""Finds the command-line program `realistic`. The program loads the library from its own folder, so a wheel has both in
one folder."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

NAME = "realistic.exe" if sys.platform == "win32" else "realistic"


def own() -> Path | None:
    """Returns the path of the program in this package; None if there is none, as after `pip install -e`."""
    file = Path(__file__).parent / NAME
    return file if file.is_file() else None


def program() -> Path:
    """Returns the program's path: the one that the variable REALISTIC_PROGRAM names, else this package's, else the one
    in PATH.

    Raises
    ------
    FileNotFoundError
        If the program is not found.
    """
    named = os.environ.get("REALISTIC_PROGRAM")
    if named:
        if not Path(named).is_file():
            raise FileNotFoundError(f"REALISTIC_PROGRAM names {named}, where there is no file")
        return Path(named)
    found = own() or shutil.which(NAME)
    if found is None:
        raise FileNotFoundError(
            "there is no program realistic here: install the package (`pip install ./python` in a checkout), build it with "
            "`cargo install --path cli`, or name it in the variable REALISTIC_PROGRAM"
        )
    return Path(found)
