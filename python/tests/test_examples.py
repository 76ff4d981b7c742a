"""Runs the examples outside the checkout, as their first lines state, and the code in the documentation and
docstrings."""

import doctest
import importlib
import re
import shutil
import subprocess
import sys
from pathlib import Path

import framing
import numpy as np
import pytest

import realistic
from realistic import _abi


def examples(checkout):
    return sorted((checkout / "python/examples").glob("*.py"))


@pytest.mark.parametrize("name", ["export_grid", "field_maps", "intrinsics", "lens_sheet", "picture"])
def test_an_example_runs_by_its_first_lines(checkout, tmp_path, name):
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
            # The documentation shows the present result; the letters that another version of matplotlib draws differ a
            # little.
            shown = {
                "export_grid": "python-export-grid.png",
                "field_maps": "python-field-maps.png",
                "lens_sheet": "python-lens-sheet.png",
                "picture": "python-picture.png",
            }[name]
            from matplotlib.image import imread

            pictures = [imread(file)[..., :3] for file in (tmp_path / argument, checkout / "docs/images" / shown)]
            assert framing.difference(*pictures) < 0.06, f"docs/images/{shown} is not what {file.name} makes"


@pytest.mark.parametrize("name", ["export_grid", "field_maps", "intrinsics", "lens_sheet", "picture"])
def test_an_example_without_arguments_prints_its_usage(checkout, tmp_path, name):
    file = checkout / f"python/examples/{name}.py"
    done = subprocess.run([sys.executable, str(file)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert f"usage: python {name}.py LENS" in done.stderr and "as in: python" in done.stderr


def test_every_example_is_tested(checkout):
    tested = ["agreement", "export_grid", "field_maps", "intrinsics", "lens_sheet", "picture", "wave_peers"]
    assert [file.stem for file in examples(checkout)] == tested


def numbers(cells):
    """Returns all numbers in some texts."""
    return [float(number) for cell in cells for number in re.findall(r"\d+\.\d+", cell)]


def test_wave_peers_compares_a_lens(checkout, tmp_path):
    """Without the other programs the table has this library's numbers; prysm, where it is, has the same."""
    file = checkout / "python/examples/wave_peers.py"
    command = [sys.executable, str(file), "tessar.50mm", "8", "10"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in done.stdout.splitlines() if " mm |" in line]
    page = (checkout / "docs/waves.md").read_text()
    for place, at in (("on the axis", "0 mm"), ("10 mm off it", "10 mm")):
        own = next(numbers(row[2:7]) for row in rows if row[:2] == [at, "realistic"])
        shown = numbers([re.search(rf"^\| {place} \|[^|]*\|(.*)$", page, re.MULTILINE).group(1)])
        # On the axis the page has the sagittal MTF once.
        np.testing.assert_allclose(own[: len(shown)], shown, atol=1.5e-4)
        for row in rows:
            if row[:2] == [at, "prysm"]:
                np.testing.assert_allclose(numbers(row[4:7]), own[2:], atol=2e-4)
    done = subprocess.run(command[:2], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and "usage: python wave_peers.py LENS" in done.stderr


def test_agreement_compares_a_folder(checkout, tmp_path):
    """Without Optiland and RayOptics the table has this library's focal lengths and what it cannot read."""
    lenses = tmp_path / "lenses"
    lenses.mkdir()
    (lenses / "biconvex.dat").write_text("50 6 1.5 20\n-50 40 1 20\n")
    (lenses / "notes.json").write_text("{}")
    file = checkout / "python/examples/agreement.py"
    command = [sys.executable, str(file), "lenses"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert f"realistic {realistic.__version__}" in done.stdout
    row = next(line for line in done.stdout.splitlines() if line.startswith("| biconvex.dat"))
    assert float(row.split("|")[2]) == pytest.approx(realistic.Lens(lenses / "biconvex.dat").focal_length_mm, 1e-5)
    assert "Not compared:" in done.stdout and "notes.json" in done.stdout
    done = subprocess.run([*command[:2], "none"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and "none is no folder" in done.stderr


def differences(shown, found):
    """Returns a message for each shown number (a text) that differs from the found one by more than a unit of its last
    digit."""
    if len(shown) != len(found):
        return [f"{len(shown)} numbers are shown and {len(found)} printed: {found}"]
    unit = [10.0 ** -len(text.partition(".")[2]) for text in shown]
    return [
        f"{text} is shown, and the program prints {number:.6g}"
        for text, number, unit in zip(shown, found, unit)
        if not abs(float(text) - number) <= 1.000001 * unit
    ]


def test_differences_are_by_the_digits_shown():
    assert differences(["0.12", "3"], [0.1244, 3.9]) == [] == differences(["-1.50"], [-1.509])
    assert len(differences(["0.12", "3"], [0.131, 4.1])) == 2 and differences(["1"], [1.0, 2.0])


@pytest.mark.parametrize("page", ["README.md", "docs/python.md", "docs/lecture.md", "python/README.md"])
def test_the_documentations_code_runs_and_prints_what_it_shows(checkout, tmp_path, monkeypatch, page):
    """A line `EXPRESSION  # ... prints 1.2, 3.4` states the numbers of its expression."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (checkout / page).read_text(), re.DOTALL)
    # tests/mitsuba3 runs the code for Mitsuba.
    blocks = [block for block in blocks if "mitsuba" not in block]
    assert blocks
    names = {"__name__": "__main__"}
    wrong, stated = [], 0
    for block in blocks:
        exec(compile(block, page, "exec"), names)
        for expression, numbers in re.findall(r"^(\S.*?)  +#[^#\n]* prints ([-\d., ]+)$", block, re.MULTILINE):
            stated += 1
            found = [
                float(number)
                for number in np.hstack([np.ravel(each) for each in np.atleast_1d(eval(expression, names))])
            ]
            wrong += [f"{page}: {expression}: {each}" for each in differences(numbers.split(", "), found)]
    assert not wrong, "\n".join(wrong)
    assert stated >= {"docs/python.md": 4}.get(page, 0)


@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
def test_the_first_c_program_prints_what_its_page_shows(checkout, tmp_path):
    page = (checkout / "docs/c.md").read_text()
    program, shown = (re.search(rf"```{mark}\n(.*?)```", page, re.DOTALL).group(1) for mark in ("c", "output"))
    (tmp_path / "first.c").write_text(program)
    library = Path(_abi.library._name).resolve()
    arguments = ["cc", f"-I{checkout}/include", "first.c", str(library), f"-Wl,-rpath,{library.parent}", "-o", "first"]
    subprocess.run(arguments, cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "first"], capture_output=True, text=True, check=True).stdout
    number = r"-?\d[\d.]*(?:e-?\d+)?"
    assert re.sub(number, "N", printed).split() == re.sub(number, "N", shown).split()
    wrong = differences(re.findall(number, shown), [float(each) for each in re.findall(number, printed)])
    assert not wrong, f"docs/c.md: {wrong}"


ROOT = Path(realistic.__file__).parent
# Modules for other programs import packages that are not installed here.
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
