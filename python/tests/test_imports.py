"""Checks that the package's modules depend on each other in one direction only."""

import ast
import graphlib
import subprocess
import sys
from pathlib import Path

import pytest

import realistic

PACKAGE = Path(realistic.__file__).parent
ROOM = {"lens": 0, "camera": 0, "measure": 1, "plot": 2, "farm": 2}
"""Order of the subpackages: a module imports no module of a later subpackage."""


def name_of(file):
    parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules():
    return {name_of(file): file for file in PACKAGE.rglob("*.py")}


def imports(name, source, is_package, known):
    """Returns the package's modules that a module imports at the top, in a function, or only for types."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            imported = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            package = name.split(".") if is_package else name.split(".")[:-1]
            within = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*within, *([node.module] if node.module else [])])
            imported = [f"{base}.{alias.name}" if f"{base}.{alias.name}" in known else base for alias in node.names]
        else:
            continue
        found |= {each for each in imported if each in known}
    return found - {name}


def all_imports():
    known = modules()
    return {
        name: imports(name, file.read_text(), file.name == "__init__.py", known) for name, file in sorted(known.items())
    }


def test_no_modules_import_each_other_in_a_circle():
    found = all_imports()
    assert len(found) > 25 and "realistic.lens" in found["realistic.measure.bundles"]
    try:
        graphlib.TopologicalSorter(found).prepare()
    except graphlib.CycleError as error:
        pytest.fail(f"a circle of imports: {' <- '.join(error.args[1])}")


def test_arrows_go_from_lens_and_camera_to_measures_to_plots():
    def room(name):
        return ROOM.get((*name.split("."), "")[1])

    for name, imported in all_imports().items():
        for other in imported:
            if room(name) is not None and room(other) is not None:
                assert room(other) <= room(name), f"{name} imports {other}"


def test_a_circle_is_found_wherever_the_import_is():
    known = {"realistic", "realistic.a", "realistic.b", "realistic.b.c"}
    for source in (
        "from . import a",
        "from .a import thing",
        "import realistic.a",
        "def f():\n    from .a import thing",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from realistic.a import T",
    ):
        assert imports("realistic.b", source, False, known) == {"realistic.a"}
        assert imports("realistic.a", source, False, known) == set()
    assert imports("realistic.b.c", "from ..a import x\nfrom .. import a", False, known) == {"realistic.a"}
    assert imports("realistic.b", "from .c import x", True, known) == {"realistic.b.c"}


def test_only_what_keeps_results_needs_sqlite3():
    """Some Pythons lack sqlite3, such as Debian's without libsqlite3."""
    code = """import sys
sys.modules["sqlite3"] = None
import realistic
print(len(realistic.study("dgauss.50mm", processes=1, fields=0, resolution=(6, 4), model="thin")))
try:
    realistic.study("dgauss.50mm", processes=1, keep="never made")
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows, message = done.stdout.splitlines()
    assert int(rows) > 0 and message.startswith("to keep results a Python with sqlite3 is needed"), done.stdout
