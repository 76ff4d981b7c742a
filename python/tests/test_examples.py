"""The examples run as their first lines say, away from the checkout; so do the documentation's code and docstrings."""

import doctest
import importlib
import re
import subprocess
import sys
from pathlib import Path

import framing
import pytest

import realistic


def examples(checkout):
    return sorted((checkout / "python/examples").glob("*.py"))


@pytest.mark.parametrize("name", ["export_grid", "intrinsics", "lens_sheet", "picture"])
def test_an_example_runs_as_it_says(checkout, tmp_path, name):
    assert name in {file.stem for file in examples(checkout)}
    file = checkout / f"python/examples/{name}.py"
    _, script, *arguments = re.search(r"^\$ (python .*)$", file.read_text(), re.MULTILINE).group(1).split()
    assert script == file.name
    done = subprocess.run([sys.executable, str(file), *arguments], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    for argument in arguments:
        if argument.endswith(".png"):
            content = (tmp_path / argument).read_bytes()
            assert content.startswith(b"\x89PNG") and len(content) > 20_000
            # The documentation shows what it makes today; letters of another matplotlib are a little different.
            shown = {
                "export_grid": "python-export-grid.png",
                "lens_sheet": "python-lens-sheet.png",
                "picture": "python-picture.png",
            }[name]
            from matplotlib.image import imread

            pictures = [imread(file)[..., :3] for file in (tmp_path / argument, checkout / "docs/images" / shown)]
            assert framing.difference(*pictures) < 0.06, f"docs/images/{shown} is not what {file.name} makes"


def test_every_example_is_tested(checkout):
    assert [file.stem for file in examples(checkout)] == ["export_grid", "intrinsics", "lens_sheet", "picture"]


def test_the_documentations_code_runs(checkout, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for page in ("README.md", "docs/python.md", "docs/lecture.md", "python/README.md"):
        blocks = re.findall(r"```python\n(.*?)```", (checkout / page).read_text(), re.DOTALL)
        # tests/mitsuba3 runs those for Mitsuba.
        blocks = [block for block in blocks if "mitsuba" not in block]
        assert blocks
        names = {"__name__": "__main__"}
        for block in blocks:
            exec(compile(block, page, "exec"), names)


ROOT = Path(realistic.__file__).parent
# Those for other programs import what is not here.
MODULES = sorted(
    ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for file in ROOT.rglob("[!_]*.py")
    if not {"mitsuba", "blender"} & set(file.relative_to(ROOT).parts)
)


@pytest.mark.parametrize("name", MODULES)
def test_docstrings_are_true(name):
    module = importlib.import_module(f"realistic.{name}")
    assert doctest.testmod(module).failed == 0
    assert doctest.testmod(realistic).failed == 0
