"""Entry point of `realistic` and `python -m realistic`: runs the command-line program in the wheel."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from ._program import own


def main() -> None:
    """Runs the program with this process's arguments; on systems that support it, the program replaces this process."""
    # PATH is not searched, because the program in it may be this very script.
    named = os.environ.get("REALISTIC_PROGRAM")
    found = Path(named) if named else own()
    if found is None or not found.is_file():
        sys.exit(
            "this installation of the package has no program: name a built one in the variable REALISTIC_PROGRAM "
            "(`cargo build --release` makes target/release/realistic)"
        )
    command = [str(found), *sys.argv[1:]]
    if sys.platform == "win32":
        sys.exit(subprocess.run(command, check=False).returncode)
    os.execv(command[0], command)


if __name__ == "__main__":
    main()
