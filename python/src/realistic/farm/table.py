"""A table with a name for each column: a NumPy structured array, written as CSV or handed to pandas."""

from __future__ import annotations

import csv
import math
import os
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Table:
    """Rows of numbers and texts.

    Attributes
    ----------
    data : ndarray (n,) with a field for each column
        `table["spot_rms_um"]` is a column of it, `table[mask]` a table of some rows.
    """

    def __init__(self, data: NDArray[Any]) -> None:
        if data.dtype.names is None or data.ndim != 1:
            raise ValueError(f"a table needs a structured array of one dimension, and not {data.dtype}, {data.shape}")
        self.data = data

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns' names."""
        return self.data.dtype.names or ()

    def __len__(self) -> int:
        return len(self.data)

    def __getitem__(self, which: Any) -> Any:
        """A column by its name, one row by its number, or a table of some rows by a slice or a mask."""
        found = self.data[which]
        return Table(found) if isinstance(found, np.ndarray) and found.dtype.names is not None else found

    def equals(self, other: Table) -> bool:
        """Whether another table has the same columns and values; NaN is the same as NaN."""
        if self.data.dtype != other.data.dtype or len(self) != len(other):
            return False
        return all(
            np.array_equal(self.data[name], other.data[name], equal_nan=self.data[name].dtype.kind == "f")
            for name in self.columns
        )

    def to_csv(self, file: str | os.PathLike[str] | TextIO) -> None:
        """Writes it, with a line of names; numbers have all their digits, and NaN is an empty cell."""
        if isinstance(file, (str, os.PathLike)):
            with open(file, "w", encoding="utf-8", newline="") as opened:
                self.to_csv(opened)
            return
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(self.columns)
        for row in self.data.tolist():
            writer.writerow(["" if isinstance(cell, float) and math.isnan(cell) else cell for cell in row])

    def to_pandas(self) -> Any:
        """The same as a `pandas.DataFrame`, which must be installed."""
        import pandas

        return pandas.DataFrame({name: self.data[name] for name in self.columns})

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows: {', '.join(self.columns)}>"
