"""Parallel work: tables of measures over many cameras, maps of point spread functions, and pictures in tiles.

All run on this machine's processors, or on a Dask cluster if a client is given.
"""

from .psf_map import PsfMap, psf_map
from .study import study
from .table import Table
from .tiles import render

__all__ = ["PsfMap", "Table", "psf_map", "render", "study"]
