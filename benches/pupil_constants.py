#!/usr/bin/env python3
"""What each constant of the pupil's map and builder trades: every one is halved and doubled.

Usage: pupil_constants.py [--film | --scene] [NAME]... [--target DIR]

The script works on a copy of the tree in a temporary folder. For each `const NAME: TYPE = VALUE;` of the two rooms it
replaces the value, builds the measuring program without optimisation, runs it and prints a row: what changes against the
tree as it stands. `--film` (default) measures src/sampling/warped by lab/examples/pupil_gate, `--scene` measures
src/camera/importance/entrance.rs and what it uses by benches/scene_points. A constant whose two rows change nothing is one
that can go. A whole sweep takes about an hour on two cores.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CONSTANT = re.compile(r"^(\s*(?:pub(?:\([a-z]+\))? )?const (\w+): (f64|usize|u32|u64|isize) = )(.+);$", re.MULTILINE)
# Fixed by the table's layout or by others beside them; the build refuses other values.
TIED = {"ROOT", "STRIDE", "KNOTS", "WIDE", "BULGE", "CELLS", "PACKET", "GROUP"}

FILM = sorted(path for path in (ROOT / "src/sampling/warped").glob("*.rs") if path.name not in ("cut.rs", "stack.rs"))
SCENE = [
    ROOT / name
    for name in ("src/camera/importance/entrance.rs", "src/sampling/warped/cut.rs", "src/sampling/warped/stack.rs")
]

# A double Gauss, an edge that jumps, both kinds of crescent, aspheres; and cameras that nobody tuned to.
FILM_RUNS = [
    ["dgauss.50mm", "sonnar.50mm", "wide.22mm", "fisheye.10mm", "fisheye.6mm", "ultrawide.14mm", "retrofocus.20mm"],
    ["--small", "phone.4mm"],
    ["40"],
]
SCENE_LENSES = ["dgauss.50mm", "sonnar.50mm", "phone.4mm", "fisheye.10mm"]


def cargo(tree: Path, target: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A command of Cargo's in the copy of the tree."""
    command = ["cargo", *arguments, "--target-dir", str(target)]
    return subprocess.run(command, cwd=tree, capture_output=True, text=True)


def film(tree: Path, target: Path) -> list[float] | None:
    """Cameras that fail the gate, least share up to .9999 in the mean, most light missed, slices and rays; None of no build."""
    if cargo(tree, target, "build", "-q", "-p", "realistic-lab", "--example", "pupil_gate").returncode != 0:
        return None
    failed, shares, missed, slices, rays = 0, [], [], 0, 0
    for run in FILM_RUNS:
        found = subprocess.run([str(target / "debug/examples/pupil_gate"), *run], capture_output=True, text=True)
        for line in found.stdout.splitlines():
            cells = line.split(" | ")
            if len(cells) < 7:
                continue
            failed += cells[0] == "NO"
            shares.append(float(cells[2].split()[0]))
            missed.append(float(cells[6].split()[0]))
            counts = re.match(r"(\d+) slices (\d+) rays", cells[7])
            if counts:
                slices, rays = slices + int(counts[1]), rays + int(counts[2])
    return [failed, sum(shares) / len(shares), max(missed), slices, rays] if shares else None


def scene(tree: Path, target: Path) -> list[float] | None:
    """First direction, ms, least mean share, least share of a point, most light left out; None of no build."""
    arguments = ["bench", "-q", "--profile", "dev", "--bench", "scene_points", "--", "--part", "4", *SCENE_LENSES]
    found = cargo(tree, target, *arguments)
    rows = [line.split(" | ") for line in found.stdout.splitlines() if line.startswith("| all |")]
    if not rows:
        return None
    number = [float(cell.split()[0].strip("|")) for cell in rows[0][1:]]
    return [number[0], number[2], number[3], number[4]]


HEADS = {
    film: ["fail the gate", "least share, mean of cameras", "light missed, most", "slices", "rays"],
    scene: ["first direction, ms", "pass, mean", "pass, of one point", "light left out"],
}


def shown(values: list[float] | None) -> str:
    """The cells of a row."""
    return " | ".join(f"{value:.6g}" for value in values) if values is not None else "no such value builds or runs"


def main() -> int:
    """Sweeps, printing a Markdown table as it goes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these constants")
    side = parser.add_mutually_exclusive_group()
    side.add_argument("--film", action="store_true", help="the film's side (default)")
    side.add_argument("--scene", action="store_true", help="the scene's side")
    parser.add_argument("--target", type=Path, help="Cargo's target folder, to keep what is built")
    given = parser.parse_args()
    measure, files = (scene, SCENE) if given.scene else (film, FILM)
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        target = given.target or Path(folder) / "target"
        shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".git", "target"))
        print(f"| constant | value | {' | '.join(HEADS[measure])} |\n|---|---|" + "---|" * len(HEADS[measure]))
        print(f"| as it stands | | {shown(measure(tree, target))} |", flush=True)
        for path in files:
            copy = tree / path.relative_to(ROOT)
            text = copy.read_text()
            for match in CONSTANT.finditer(text):
                before, name, kind, value = match.groups()
                if name in TIED or (given.names and name not in given.names):
                    continue
                for part, by in (("/ 2", 0.5), ("x 2", 2)):
                    if kind == "f64":
                        changed = f"({value}) * {by:.1f}"
                    else:
                        changed = f"({value}) / 2" if by < 1 else f"({value}) * 2"
                    copy.write_text(text[: match.start()] + f"{before}{changed};" + text[match.end() :])
                    row = shown(measure(tree, target))
                    print(f"| `{path.stem}::{name}` | {value} {part} | {row} |", flush=True)
            copy.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
