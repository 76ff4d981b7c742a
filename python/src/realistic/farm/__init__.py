"""Parallel work: tables of measures over many cameras, and pictures in tiles.

Both run on this machine's processors, or on a Dask cluster if a client is given.
"""

from .study import study
from .table import Table
from .tiles import render

__all__ = ["Table", "render", "study"]
