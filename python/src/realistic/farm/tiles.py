"""Renders pictures in tiles with the command-line program. The joined tiles have the same bytes as a picture rendered
whole."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from .._program import program as installed_program
from .workers import Progress, Workers

_SIZE = (480, 320)
"""The program's default picture size."""


def render(
    out: str | os.PathLike[str],
    options: Sequence[str] = (),
    *,
    size: tuple[int, int] = _SIZE,
    tile: tuple[int, int] = (128, 128),
    client: Any = None,
    processes: int | None = None,
    retries: int = 2,
    keep: str | os.PathLike[str] | None = None,
    progress: bool | Progress = True,
    program: str | os.PathLike[str] | None = None,
) -> Path:
    """Renders a picture with `realistic render`, in many processes at once.

    The file has the same bytes as a picture rendered in one piece, no matter which workers render a tile, or how often.

    Parameters
    ----------
    out : str or path-like
        The picture to write, .png or .exr.
    options : sequence of str
        Options of `realistic render`, such as `["--lens", "wide.22mm", "--spp", "64"]`, except those that this function
        sets (`--size`, `--out`, `--crop`, `--threads`) and `--slide`.
    size : (int, int)
        Width and height of the picture, pixels.
    tile : (int, int)
        Width and height of a tile, pixels; tiles at the right and lower edge are smaller.
    client : dask.distributed.Client or concurrent.futures.Executor, optional
        Workers for the tiles; default processes of this machine. Workers return tiles as bytes, so that no shared files
        are needed.
    processes : int, optional
        Number of processes of this machine; default one per processor.
    retries : int
        Number of further attempts for a tile that failed or whose process died.
    keep : str or path-like, optional
        A folder that keeps each tile when it arrives, as in `study`: an interrupted picture continues where it stopped.
    progress : bool or callable
        As in `study`.
    program : str or path-like, optional
        Path of the program on the workers; default the program of the package that is installed there.

    Returns
    -------
    Path
        The picture.

    Raises
    ------
    ValueError
        For an option that this function refuses, and for invalid sizes.
    RuntimeError
        If the program fails at every attempt for a tile, with the program's message; or if the program is not found.
        The other tiles are kept.
    """
    target = Path(out)
    for option in options:
        name = option.partition("=")[0]
        if name in ("--size", "--out", "--crop", "--threads", "--slide"):
            raise ValueError(f"{name} is not an option of a picture in tiles")
        if "-" in (option, option.partition("=")[2]):
            raise ValueError("standard input cannot be read for each tile: name a file")
    workers = Workers(client, processes, retries, keep, progress)
    width, height = size
    across, down = tile
    if min(width, height, across, down) < 1:
        raise ValueError(f"pictures and tiles have a pixel at least: size is {size}, tile {tile}")
    named = None if program is None else os.fspath(program)
    jobs = [
        _Tile((x, y, min(x + across, width), min(y + down, height)), size, tuple(options), named, target.suffix)
        for y in range(0, height, down)
        for x in range(0, width, across)
    ]
    with tempfile.TemporaryDirectory() as room:
        files = []
        for number, content in enumerate(workers.do(_rendered, jobs, _failed, "tile")):
            file = Path(room) / f"{number}{target.suffix}"
            file.write_bytes(content)
            files.append(str(file))
        _run(named, ["merge", *files, "--out", str(target)])
    return target


@dataclass(frozen=True)
class _Tile:
    """One tile of a picture; `crop` is its first column, first row, end column and end row (ends exclusive)."""

    crop: tuple[int, int, int, int]
    size: tuple[int, int]
    options: tuple[str, ...]
    program: str | None
    ending: str


def _rendered(tile: _Tile) -> bytes:
    """Renders a tile and returns the bytes of its file."""
    with tempfile.TemporaryDirectory() as room:
        file = Path(room) / f"tile{tile.ending}"
        crop = ",".join(map(str, tile.crop))
        arguments = ["render", *tile.options, "--size", f"{tile.size[0]}x{tile.size[1]}"]
        # A worker has one processor to itself; names of lens files are relative to the worker's folder.
        _run(tile.program, [*arguments, "--crop", crop, "--threads", "1", "--out", str(file)])
        return file.read_bytes()


def _failed(_tile: _Tile, error: Exception) -> NoReturn:
    """Raises the error of a failed tile, because the picture needs every tile."""
    died = isinstance(error, BrokenExecutor)
    raise RuntimeError("the process that rendered a tile died each time") if died else error


def _run(named: str | None, arguments: Sequence[str]) -> None:
    try:
        command = [str(installed_program()) if named is None else named, *arguments]
    except FileNotFoundError as error:
        raise RuntimeError(str(error)) from None
    if shutil.which(command[0]) is None:
        raise RuntimeError(f"there is no program {command[0]} here: name another in `program`")
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip() or done.returncode}")
