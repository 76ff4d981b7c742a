"""Results in a folder, by the content of their jobs: what an interrupted run leaves for the next one."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._abi import library_file
from .._program import program

if TYPE_CHECKING:
    from collections.abc import Iterator

_PACKAGE = Path(__file__).parents[1]


class Kept:
    """The results in a folder, a `diskcache.Cache`: several processes may use it at once, and die as they write.

    A result's key covers all that determines the result: the job itself, the content of the files that it names and of the
    glass catalogues beside them, and this package with its library and program.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        try:
            import diskcache
        except ImportError:
            raise ImportError('to keep results diskcache is needed: pip install "./python[farm]"') from None
        # Results stay, however many there are.
        self._cache = diskcache.Cache(os.fspath(folder), eviction_policy="none")
        self._digest_of_file = cache(_digest)
        self._here = _of_this_package()

    def key(self, job: Any) -> str:
        """The key of a job, a dataclass."""
        fields = json.loads(json.dumps(dataclasses.asdict(job), default=_plain))
        files = {str(file): self._digest_of_file(file) for text in _texts(fields) for file in _read_for(text)}
        content = json.dumps([self._here, type(job).__qualname__, fields, files], sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()

    def get(self, key: str) -> bytes | None:
        """The result, if it is there."""
        found = self._cache.get(key)
        return found if isinstance(found, bytes) else None

    def put(self, key: str, result: bytes) -> None:
        """Keeps a result."""
        self._cache.set(key, result)

    def close(self) -> None:
        """Closes the files."""
        self._cache.close()


def _of_this_package() -> str:
    """A digest of this package, its library and its program."""
    files = [*sorted(_PACKAGE.rglob("*.py")), library_file()]
    try:
        files.append(program())
    except FileNotFoundError:
        pass
    return hashlib.sha256("".join(map(_digest, files)).encode()).hexdigest()


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _read_for(text: str) -> Iterator[Path]:
    """The files that a text of a job names, alone or as an option's value, and the glass catalogues beside them."""
    value = text.partition("=")[2] or text
    # A lens may be scaled: NAME@35mm. The library looks for it in the working directory and beside itself.
    for name in {value, value.rpartition("@")[0]} - {""}:
        for file in (Path(name), library_file().parent / name):
            if os.path.isfile(file):
                yield file
                yield from sorted(near for near in file.parent.iterdir() if near.suffix.lower() == ".agf")


def _texts(value: Any) -> Iterator[str]:
    """All texts in what JSON holds."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for each in value.values():
            yield from _texts(each)
    elif isinstance(value, list):
        for each in value:
            yield from _texts(each)


def _plain(value: Any) -> Any:
    """What JSON does not know, as what it knows."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, bytes):
        return value.hex()
    return list(value)
