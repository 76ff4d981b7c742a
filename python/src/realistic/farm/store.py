"""Stores results in a folder, keyed by the content of their jobs, so that another run can continue an interrupted
one."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import warnings
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._abi import library_file
from .._program import program

try:
    import sqlite3
except ImportError as missing:
    raise ImportError(f"to keep results a Python with sqlite3 is needed, which this one lacks: {missing}") from None

if TYPE_CHECKING:
    from collections.abc import Iterator

_PACKAGE = Path(__file__).parents[1]
_SUM = hashlib.sha256().digest_size


class Store:
    """A folder of results, kept by `diskcache.Cache`. Several processes may use it at once, and may die while they
    write.

    A result's key covers everything that determines the result: the job itself, the content of the files that it names
    and of the glass catalogues beside them, and this package with its library and program.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        try:
            import diskcache
        except ImportError:
            raise ImportError('to keep results diskcache is needed: pip install "./python[farm]"') from None
        self._folder = Path(folder)
        # Results are never evicted.
        try:
            self._cache = diskcache.Cache(os.fspath(folder), eviction_policy="none")
        except sqlite3.DatabaseError as damage:
            warnings.warn(f"{self._folder} is damaged ({damage}): what it keeps is computed anew", stacklevel=4)
            for part in self._folder.glob("cache.db*"):
                part.replace(part.with_name(f"damaged-{part.name}"))
            self._cache = diskcache.Cache(os.fspath(folder), eviction_policy="none")
        self._digest_of_file = cache(_digest)
        self._package_digest = _digest_of_package()

    def key(self, job: Any) -> str:
        """Returns the key of a job, which is a dataclass."""
        fields = json.loads(json.dumps(dataclasses.asdict(job), default=_plain))
        files = {str(file): self._digest_of_file(file) for text in _texts(fields) for file in _read_for(text)}
        content = json.dumps([self._package_digest, type(job).__qualname__, fields, files], sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()

    def get(self, key: str) -> bytes | None:
        """Returns the result if it is stored undamaged, else None."""
        try:
            found = self._cache.get(key)
        except (sqlite3.DatabaseError, OSError, ValueError, EOFError):
            return None
        if not isinstance(found, bytes) or found[:_SUM] != hashlib.sha256(found[_SUM:]).digest():
            return None
        return found[_SUM:]

    def put(self, key: str, result: bytes) -> None:
        """Stores a result with its digest."""
        try:
            self._cache.set(key, hashlib.sha256(result).digest() + result)
        except sqlite3.DatabaseError as damage:
            warnings.warn(f"a result cannot be kept in {self._folder}: {damage}", stacklevel=4)

    def close(self) -> None:
        """Closes the files."""
        self._cache.close()


def _digest_of_package() -> str:
    """Returns a digest of this package, its library and its program."""
    files = [*sorted(_PACKAGE.rglob("*.py")), library_file()]
    try:
        files.append(program())
    except FileNotFoundError:
        pass
    return hashlib.sha256("".join(map(_digest, files)).encode()).hexdigest()


def _digest(file: Path) -> str:
    """Returns a digest of a file, or of the reason why it cannot be read."""
    digest = hashlib.sha256()
    try:
        with file.open("rb") as content:
            while block := content.read(1 << 20):
                digest.update(block)
    except OSError as error:
        return f"unreadable: {error.errno}"
    return digest.hexdigest()


def _read_for(text: str) -> Iterator[Path]:
    """Yields the files that a string in a job names, as a whole or as an option's value, and the glass catalogues
    beside them."""
    value = text.partition("=")[2] or text
    # NAME@35mm is a scaled lens. The library looks for lens files in the working directory and beside itself.
    for name in {value, value.rpartition("@")[0]} - {""}:
        for file in (Path(name), library_file().parent / name):
            if os.path.isfile(file):
                yield file
                yield from _catalogues(file.parent)


def _catalogues(folder: Path) -> list[Path]:
    """Returns the glass catalogues in a folder: only regular files, because the library reads no others."""
    try:
        return sorted(file for file in folder.iterdir() if file.suffix.lower() == ".agf" and file.is_file())
    except OSError:
        return []


def _texts(value: Any) -> Iterator[str]:
    """Yields all strings in a JSON value."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for each in value.values():
            yield from _texts(each)
    elif isinstance(value, list):
        for each in value:
            yield from _texts(each)


def _plain(value: Any) -> Any:
    """Converts a value that JSON does not support to one that it supports."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, bytes):
        return value.hex()
    return list(value)
