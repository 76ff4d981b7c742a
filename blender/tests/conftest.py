"""Fixtures for tests in the real Blender as a Python module (`bpy`), which installs extensions into a temporary folder.

REALISTIC_PROGRAM names the built program; REALISTIC_PLUGIN names the built library, which traces rays in double
precision.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pytest

# The variable is set before Blender reads it, so that the extension is not installed into the user's own Blender.
ROOM = tempfile.TemporaryDirectory(prefix="blender-")
os.environ["BLENDER_USER_RESOURCES"] = ROOM.name

import bpy

# Folder that contains the paths to add: the program Blender adds them to Python's path itself, the module does not.
HOME = next(parent for parent in Path(bpy.__file__).resolve().parents if parent.name[0].isdigit())
sys.path += [str(HOME / "python/lib/python3.11/site-packages"), str(HOME / "scripts/addons_core")]


@pytest.fixture(scope="session")
def program() -> str:
    """The built program."""
    return os.environ["REALISTIC_PROGRAM"]


@pytest.fixture(scope="session")
def zip_file(program, tmp_path_factory) -> Path:
    """The extension's zip."""
    file = tmp_path_factory.mktemp("extension") / "realistic.zip"
    script = Path(__file__).parents[1] / "make_extension.py"
    subprocess.run([sys.executable, script, file, program], check=True)
    return file


@pytest.fixture(scope="session")
def lenses(zip_file, tmp_path_factory) -> dict[str, tuple[str, dict[str, object]]]:
    """The shader's text and the facts of every lens in the extension."""
    with zipfile.ZipFile(zip_file) as archive:
        facts = json.loads(archive.read("lenses/lenses.json"))
        return {name: (archive.read(f"lenses/{name}.osl").decode(), lens_facts) for name, lens_facts in facts.items()}
