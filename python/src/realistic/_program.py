"""Finds the command-line program `realistic` and runs it. The program loads the library from its own folder, so a wheel
has both in one folder."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .errors import Error

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


def report(words: Sequence[str], parameters: Mapping[str, Any]) -> Any:
    """Runs a command of the program with a lens and returns its JSON.

    Parameters
    ----------
    words : sequence of str
        The command with its options, without `--json`.
    parameters : mapping
        Parameters of the lens by their names; `lens_text` is piped to the program.

    Raises
    ------
    realistic.Error
        If the program fails, with its message.
    FileNotFoundError
        If the program is not found.
    """
    given = {"lens_file": "dgauss.50mm", **parameters}
    lens_text = given.pop("lens_text", None)
    if lens_text is not None:
        given["lens_file"] = "-"
    options = [f"--param={name}={_text(value)}" for name, value in given.items() if value is not None]
    command = [str(program()), *words, "--json", "--quiet", *options]
    text = lens_text.encode() if isinstance(lens_text, str) else lens_text
    completed = subprocess.run(command, input=text or b"", capture_output=True, check=False)
    if completed.returncode != 0:
        message = completed.stderr.decode(errors="replace").strip()
        raise Error(message.removeprefix("realistic: error: ") or f"{command[0]} failed")
    return json.loads(completed.stdout)


def _text(value: Any) -> str:
    """Formats a parameter's value for the command line."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, (tuple, list, np.ndarray)):
        return ",".join(repr(float(each)) for each in value)
    return repr(float(value))
