"""Builds the library and the command-line program with cargo and puts them into the wheel: one wheel per platform, for
every Python 3. The source distribution contains the files that cargo needs, in a separate folder, and is built in the
same way.

The variables `REALISTIC_LIBRARY` and `REALISTIC_PROGRAM` name prebuilt files, which the wheel then contains unchanged.
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

# The platform's file names of the shared library and the program.
LIBRARY = {"darwin": "librealistic.dylib", "win32": "realistic.dll"}.get(sys.platform, "librealistic.so")
PROGRAM = "realistic.exe" if sys.platform == "win32" else "realistic"
PACKAGES = {LIBRARY: "realistic", PROGRAM: "realistic-cli"}

# Files of the checkout that cargo reads to build the two, and the licences.
SOURCES = ("Cargo.toml", "Cargo.lock", "build.rs", "src", "crates", "include", "pbrt-shim", "cli", "lab")
LICENCES = ("LICENSE-MIT", "LICENSE-APACHE")
# Folder of these files in a source distribution.
CARRIED = "workspace"


class LibraryHook(BuildHookInterface[Any]):
    """Build hook: hatchling calls it before it writes a wheel or a source distribution."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        carried = Path(self.root) / CARRIED
        workspace = carried if carried.is_dir() else Path(self.root).parent
        # All files of a source distribution have the same date, from which cargo would conclude that a build of another
        # version is up to date. So they are touched.
        for source in carried.rglob("*"):
            source.touch()
        included = build_data["force_include"]
        if self.target_name == "sdist":
            for name in SOURCES + LICENCES:
                included[str(workspace / name)] = f"{CARRIED}/{name}"
            return
        if version == "editable":
            # An editable install contains neither library nor program; REALISTIC_PLUGIN and REALISTIC_PROGRAM name them
            # when Python runs.
            return
        files = {LIBRARY: named("REALISTIC_LIBRARY"), PROGRAM: named("REALISTIC_PROGRAM")}
        missing = [name for name, file in files.items() if file is None]
        if missing:
            files |= build(workspace, missing)
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
        build_data["pure_python"] = False
        if sys.platform == "linux":
            # `.ci/release` links and tags released wheels, which load on older systems.
            self.app.display_info(
                f"{platform}: for systems with this one's {os.confstr('CS_GNU_LIBC_VERSION')} or newer"
            )
        # The program looks for the library in its own folder.
        for name, file in files.items():
            included[str(file)] = f"realistic/{name}"
        for licence in LICENCES:
            included[str(workspace / licence)] = f"realistic/licenses/{licence}"


def named(variable: str) -> Path | None:
    """Returns the file that an environment variable names; None if it is not set."""
    value = os.environ.get(variable)
    if not value:
        return None
    if not Path(value).is_file():
        raise SystemExit(f"{variable} names {value}, where there is no file")
    return Path(value)


def build(workspace: Path, names: list[str]) -> dict[str, Path]:
    """Builds library and program, or one of them, in the checkout's `target/python`, without pbrt's C++ interface, so
    that no C++ compiler is needed.
    """
    cargo = os.environ.get("CARGO") or shutil.which("cargo")
    if cargo is None:
        raise SystemExit(
            "the package's library is written in Rust, and there is no cargo in PATH: install Rust (https://rustup.rs) "
            "and try again, or name a built library and program in the variables REALISTIC_LIBRARY and REALISTIC_PROGRAM"
        )
    manifest = workspace / "Cargo.toml"
    if not manifest.is_file():
        raise SystemExit(
            f"{manifest} is not there: the package is built from a checkout of the whole project, or from its source "
            "distribution"
        )
    # The path is relative to the checkout, because pip runs this hook in another folder than the user's.
    target = workspace / (os.environ.get("CARGO_TARGET_DIR") or "target") / "python"
    command = [cargo, "build", "--release", "--locked"]
    command += [f"--package={PACKAGES[name]}" for name in names]
    command += ["--manifest-path", str(manifest), "--target-dir", str(target)]
    command += ["--message-format", "json-render-diagnostics"]
    environment = {**os.environ, "REALISTIC_NO_SHIM": "1"}
    completed = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    if completed.returncode != 0:
        raise SystemExit(f"cargo failed: {' '.join(command)}")
    found = {}
    for line in completed.stdout.splitlines():
        for file in map(Path, json.loads(line).get("filenames", [])):
            if file.name in names:
                found[file.name] = file
    if missing := set(names) - set(found):
        raise SystemExit(f"cargo built no {' and no '.join(sorted(missing))}: {' '.join(command)}")
    return found
