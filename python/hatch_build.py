"""Builds the library with cargo and puts it into the wheel: one wheel per platform, for every Python 3.

`REALISTIC_LIBRARY` names a library that is built already, which is then taken as it is.
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

# The linker's name for a shared library.
NAME = {"darwin": "librealistic.dylib", "win32": "realistic.dll"}.get(sys.platform, "librealistic.so")


class LibraryHook(BuildHookInterface[Any]):
    """Called by hatchling before it writes a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if self.target_name != "wheel":
            raise SystemExit(
                "this package is built from a checkout of the whole project, whose library it carries, and has no "
                "source distribution: use `pip install ./python` or `pip wheel --no-deps ./python`"
            )
        if version == "editable":
            # The source tree has no library: REALISTIC_PLUGIN names one when Python runs.
            return
        workspace = Path(self.root).parent
        named = os.environ.get("REALISTIC_LIBRARY")
        library = Path(named) if named else build(workspace)
        if not library.is_file():
            raise SystemExit(f"REALISTIC_LIBRARY names {library}, where there is no file")
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
        build_data["pure_python"] = False
        included = build_data["force_include"]
        included[str(library)] = f"realistic/{NAME}"
        for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
            included[str(workspace / licence)] = f"realistic/licenses/{licence}"


def build(workspace: Path) -> Path:
    """The library, built in the checkout's `target/python`, without pbrt's C++ face: no C++ compiler is needed."""
    cargo = os.environ.get("CARGO") or shutil.which("cargo")
    if cargo is None:
        raise SystemExit(
            "the package's library is written in Rust, and there is no cargo in PATH: install Rust (https://rustup.rs) "
            "and try again, or name a built library in the variable REALISTIC_LIBRARY"
        )
    manifest = workspace / "Cargo.toml"
    if not manifest.is_file():
        raise SystemExit(f"{manifest} is not there: the package is built from a checkout of the whole project")
    # pip runs this in another folder than the caller of cargo has in mind.
    target = workspace / (os.environ.get("CARGO_TARGET_DIR") or "target") / "python"
    command = [cargo, "build", "--release", "--locked", "--package", "realistic", "--lib"]
    command += ["--manifest-path", str(manifest), "--target-dir", str(target)]
    command += ["--message-format", "json-render-diagnostics"]
    told = subprocess.run(command, env={**os.environ, "REALISTIC_NO_SHIM": "1"}, stdout=subprocess.PIPE, text=True)
    if told.returncode != 0:
        raise SystemExit(f"cargo failed: {' '.join(command)}")
    for line in told.stdout.splitlines():
        message = json.loads(line)
        for file in message.get("filenames", []):
            if Path(file).name == NAME:
                return Path(file)
    raise SystemExit(f"cargo built no {NAME}: {' '.join(command)}")
