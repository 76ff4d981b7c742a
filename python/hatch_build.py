"""Builds the library and the command-line program with cargo and puts them into the wheel: one wheel per platform, for every
Python 3.

`REALISTIC_LIBRARY` and `REALISTIC_PROGRAM` name ones that are built already, which are then taken as they are.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

# The linker's names for a shared library and a program.
LIBRARY = {"darwin": "librealistic.dylib", "win32": "realistic.dll"}.get(sys.platform, "librealistic.so")
PROGRAM = "realistic.exe" if sys.platform == "win32" else "realistic"
PACKAGES = {LIBRARY: "realistic", PROGRAM: "realistic-cli"}


class LibraryHook(BuildHookInterface[Any]):
    """Called by hatchling before it writes a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if self.target_name != "wheel":
            raise SystemExit(
                "this package is built from a checkout of the whole project, whose library it carries, and has no "
                "source distribution: use `pip install ./python` or `pip wheel --no-deps ./python`"
            )
        if version == "editable":
            # The source tree has neither: REALISTIC_PLUGIN and REALISTIC_PROGRAM name them when Python runs.
            return
        workspace = Path(self.root).parent
        files = {LIBRARY: named("REALISTIC_LIBRARY"), PROGRAM: named("REALISTIC_PROGRAM")}
        missing = [name for name, file in files.items() if file is None]
        if missing:
            files |= build(workspace, missing)
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
        build_data["pure_python"] = False
        included = build_data["force_include"]
        # Beside each other: there the program looks for the library.
        for name, file in files.items():
            included[str(file)] = f"realistic/{name}"
        for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
            included[str(workspace / licence)] = f"realistic/licenses/{licence}"


def named(variable: str) -> Path | None:
    """The file that a variable of the environment names; None where it is not set."""
    value = os.environ.get(variable)
    if not value:
        return None
    if not Path(value).is_file():
        raise SystemExit(f"{variable} names {value}, where there is no file")
    return Path(value)


def build(workspace: Path, wanted: list[str]) -> dict[str, Path]:
    """Library and program, or one of them, built in the checkout's `target/python`, without pbrt's C++ face: no C++ compiler is
    needed.
    """
    cargo = os.environ.get("CARGO") or shutil.which("cargo")
    if cargo is None:
        raise SystemExit(
            "the package's library is written in Rust, and there is no cargo in PATH: install Rust (https://rustup.rs) "
            "and try again, or name a built library and program in the variables REALISTIC_LIBRARY and REALISTIC_PROGRAM"
        )
    manifest = workspace / "Cargo.toml"
    if not manifest.is_file():
        raise SystemExit(f"{manifest} is not there: the package is built from a checkout of the whole project")
    # pip runs this in another folder than the caller of cargo has in mind.
    target = workspace / (os.environ.get("CARGO_TARGET_DIR") or "target") / "python"
    command = [cargo, "build", "--release", "--locked"]
    command += [f"--package={PACKAGES[name]}" for name in wanted]
    command += ["--manifest-path", str(manifest), "--target-dir", str(target)]
    command += ["--message-format", "json-render-diagnostics"]
    environment = {**os.environ, "REALISTIC_NO_SHIM": "1"}
    told = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    if told.returncode != 0:
        raise SystemExit(f"cargo failed: {' '.join(command)}")
    found = {}
    for line in told.stdout.splitlines():
        for file in map(Path, json.loads(line).get("filenames", [])):
            if file.name in wanted:
                found[file.name] = file
    if missing := set(wanted) - set(found):
        raise SystemExit(f"cargo built no {' and no '.join(sorted(missing))}: {' '.join(command)}")
    return found
