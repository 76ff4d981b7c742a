"""Makes the extension's zip: the code and, for every lens of the catalogue, a shader, a cross-section and its facts.
Lenses with mirrors have no shader and are left out.

    python3 blender/make_extension.py OUT.zip [PROGRAM]

PROGRAM is the built `realistic`; without it, the one in PATH.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import zipfile
from concurrent.futures import ThreadPoolExecutor
from os import cpu_count
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Prefix of a shader's line of facts.
FACTS = "// facts: "


def run(program: str, *arguments: str) -> str:
    """Returns the program's output; ends the script if the program fails."""
    completed = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if completed.returncode != 0:
        raise SystemExit(f"{program} {' '.join(arguments)}: {completed.stderr.strip()}")
    return completed.stdout


def lens(program: str, name: str, folder: Path) -> dict[str, object]:
    """Writes a lens's shader and picture and returns its facts."""
    shader = run(program, "blender", name, "--out", "-")
    (folder / f"{name}.osl").write_text(shader)
    run(program, "draw", name, "--out", str(folder / f"{name}.png"))
    facts = next(line for line in shader.splitlines() if line.startswith(FACTS))
    return json.loads(facts.removeprefix(FACTS))


def main(out: Path, program: str) -> None:
    """Writes the extension's zip."""
    # The list has a heading and one line per lens.
    listed = [line.split()[0] for line in run(program, "lens", "--list").splitlines()[1:]]
    names = [name for name in listed if json.loads(run(program, "lens", name, "--json"))["mirrors"] == 0]
    with tempfile.TemporaryDirectory() as made, ThreadPoolExecutor(cpu_count()) as pool:
        folder = Path(made)
        facts = dict(zip(names, pool.map(lambda name: lens(program, name, folder), names)))
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for file in ("__init__.py", "blender_manifest.toml", "LICENSE"):
                archive.write(HERE / "extension" / file, file)
            for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
                archive.write(HERE.parent / licence, licence)
            archive.writestr("lenses/lenses.json", json.dumps(facts, indent=1))
            for file in sorted(folder.iterdir()):
                archive.write(file, f"lenses/{file.name}")
    print(f"{out}: {len(names)} lenses, {out.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 3:
        raise SystemExit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2] if len(sys.argv) == 3 else "realistic")
