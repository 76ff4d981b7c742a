#!/usr/bin/env python3
"""What each constant of the pupil's map and builder trades: every one is halved and doubled.

Usage: pupil_constants.py [--film | --scene] [NAME]... [--target DIR]

The script works on a copy of the tree in a temporary folder, where each `const NAME: TYPE = VALUE;` of the two rooms reads
its value times the environment's SWEEP_FILE_NAME when the program starts. So the measuring program is built once and run for
each value; a row says what changes against the tree as it stands. `--film` (default) measures src/sampling/warped by
lab/examples/pupil_gate, `--scene` measures src/camera/importance/entrance.rs and what it uses by benches/scene_points.
A constant whose two rows change nothing is one that can go. The build takes some minutes, each row some seconds.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CONSTANT = re.compile(
    r"^(\s*)(pub(?:\([a-z]+\))? )?const (\w+): (f64|usize|u32|u64) = (.+);$",
    re.MULTILINE,
)
# Lengths of arrays and what is tied to them by the table's layout: the compiler needs their values.
TIED = {
    "ROOT",
    "STRIDE",
    "KNOTS",
    "WIDE",
    "BULGE",
    "CELLS",
    "PACKET",
    "SECTORS",
    "FINE",
    "HALF_LINES",
}

FILM = sorted(
    path
    for path in (ROOT / "src/sampling/warped").glob("*.rs")
    if path.name not in ("cut.rs", "spectral.rs")
)
SCENE = [
    ROOT / name
    for name in ("src/camera/importance/entrance.rs", "src/sampling/warped/cut.rs")
]

# A double Gauss, an edge that jumps, both kinds of crescent, aspheres; and cameras that nobody tuned to.
FILM_RUNS = [
    [
        "dgauss.50mm",
        "sonnar.50mm",
        "wide.22mm",
        "fisheye.10mm",
        "fisheye.6mm",
        "ultrawide.14mm",
        "retrofocus.20mm",
    ],
    ["--small", "phone.4mm"],
    ["40"],
]
SCENE_LENSES = ["dgauss.50mm", "sonnar.50mm", "phone.4mm", "fisheye.10mm"]


def swept(file: Path, name: str) -> str:
    """The environment's name for the factor of a constant."""
    return f"SWEEP_{file.stem}_{name}".upper()


def read_at_start(tree: Path, files: list[Path]) -> list[tuple[Path, str, str]]:
    """Rewrites the constants of a copied tree as values that are read at the start; returns (file, name, value) of each."""
    found = []
    for file in files:
        text = file.read_text()
        mine = [
            match.groups() for match in CONSTANT.finditer(text) if match[3] not in TIED
        ]
        found += [(file, name, value) for _, _, name, _, value in mine]
        copy = tree / file.relative_to(ROOT)
        copy.write_text(CONSTANT.sub(partial(static, file), text))
        for _, public, name, _, _ in mine:
            for user in tree.glob("src/**/*.rs") if public else [copy]:
                uses(user, name, "" if user == copy else f"{file.stem}::")
    return found


def static(file: Path, match: re.Match[str]) -> str:
    """The declaration of a constant that is read at the start."""
    indent, public, name, kind, value = match.groups()
    if name in TIED:
        return match[0]
    by = f'std::env::var("{swept(file, name)}").map_or(1.0, |by| by.parse::<f64>().unwrap())'
    read = f"({value}) as f64 * {by}"
    return f"{indent}{public or ''}static {name}: std::sync::LazyLock<{kind}> = std::sync::LazyLock::new(|| ({read}) as {kind});"


def uses(file: Path, name: str, module: str) -> None:
    """Dereferences a constant wherever code uses it: by its name alone, and elsewhere by its module or an import."""
    text = file.read_text()
    imported = module and re.search(
        rf"use [^;]*\b{module}(?:\{{[^;]*)?\b{name}\b", text
    )
    if module and not imported and f"{module}{name}" not in text:
        return
    path = r"((?:\w+::)*)" if imported or not module else rf"((?:\w+::)*{module})"
    skipped = rf"//[^\n]*|\buse [^;]*;|static {name}:"
    use = re.compile(rf"({skipped})|(?<![\w:]){path}\b{name}\b(?!\()")
    file.write_text(use.sub(lambda found: found[1] or f"(*{found[2]}{name})", text))


def build(tree: Path, target: Path, *what: str) -> Path:
    """Builds a measuring program of the copied tree; its path."""
    command = [
        "cargo",
        "build",
        "--release",
        "--message-format=json-render-diagnostics",
        *what,
        "--target-dir",
        str(target),
    ]
    quiet = os.environ | {"RUSTFLAGS": "-A warnings"}
    told = subprocess.run(
        command, check=False, cwd=tree, env=quiet, capture_output=True, text=True
    )
    if told.returncode != 0:
        sys.exit(
            f"the copy with values read at the start does not build:\n{told.stderr}"
        )
    programs = [json.loads(line).get("executable") for line in told.stdout.splitlines()]
    # Away from where another build would replace it.
    return Path(
        shutil.copy(next(path for path in reversed(programs) if path), tree.parent)
    )


def film(program: Path, factors: dict[str, str]) -> list[float] | None:
    """Cameras that fail the gate, least share up to .9999 in the mean, most light missed, slices and rays; None of a failure."""
    failed, shares, missed, slices, rays = 0, [], [], 0, 0
    for run in FILM_RUNS:
        for line in output(program, factors, *run):
            cells = line.split(" | ")
            if len(cells) < 7:
                continue
            failed += cells[0] == "NO"
            shares.append(float(cells[2].split()[0]))
            missed.append(float(cells[6].split()[0]))
            counts = re.match(r"(\d+) slices (\d+) rays", cells[7])
            if counts:
                slices, rays = slices + int(counts[1]), rays + int(counts[2])
    return (
        [failed, sum(shares) / len(shares), max(missed), slices, rays]
        if shares
        else None
    )


def scene(program: Path, factors: dict[str, str]) -> list[float] | None:
    """First direction, ms, least mean share, least share of a point, most light left out; None of a failure."""
    rows = [
        line.split(" | ")
        for line in output(program, factors, "--part", "4", *SCENE_LENSES)
        if line.startswith("| all |")
    ]
    if not rows:
        return None
    number = [float(cell.split()[0].strip("|")) for cell in rows[0][1:]]
    return [number[0], number[2], number[3], number[4]]


def output(program: Path, factors: dict[str, str], *arguments: str) -> list[str]:
    """The lines that a measuring program prints with some constants changed; what takes over five minutes prints none."""
    command = [str(program), *arguments]
    try:
        run = subprocess.run(
            command,
            check=False,
            env=os.environ | factors,
            capture_output=True,
            text=True,
            timeout=300,
        )
    except subprocess.TimeoutExpired:
        return []
    return run.stdout.splitlines() if run.returncode == 0 else []


PROGRAM = {
    film: ("-p", "realistic-lab", "--example", "pupil_gate"),
    scene: ("--bench", "scene_points"),
}
HEADS = {
    film: [
        "fail the gate",
        "least share, mean of cameras",
        "light missed, most",
        "slices",
        "rays",
    ],
    scene: [
        "first direction, ms",
        "pass, mean",
        "pass, of one point",
        "light left out",
    ],
}


def shown(values: list[float] | None) -> str:
    """The cells of a row."""
    return (
        " | ".join(f"{value:.6g}" for value in values)
        if values is not None
        else "no figure: it fails or takes over 5 minutes"
    )


def main() -> int:
    """Sweeps, printing a Markdown table as it goes."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these constants")
    side = parser.add_mutually_exclusive_group()
    side.add_argument("--film", action="store_true", help="the film's side (default)")
    side.add_argument("--scene", action="store_true", help="the scene's side")
    parser.add_argument(
        "--target", type=Path, help="Cargo's target folder, to keep what is built"
    )
    given = parser.parse_args()
    measure, files = (scene, SCENE) if given.scene else (film, FILM)
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        target = given.target or Path(folder) / "target"
        shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".git", "target"))
        constants = read_at_start(tree, files)
        program = build(tree, target, *PROGRAM[measure])
        print(
            f"| constant | value | {' | '.join(HEADS[measure])} |\n|---|---|"
            + "---|" * len(HEADS[measure])
        )
        print(f"| as it stands | | {shown(measure(program, {}))} |", flush=True)
        for file, name, value in constants:
            if given.names and name not in given.names:
                continue
            for part, by in (("/ 2", "0.5"), ("x 2", "2")):
                row = shown(measure(program, {swept(file, name): by}))
                print(f"| `{file.stem}::{name}` | {value} {part} | {row} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
