"""A table with a name for each column: a NumPy structured array, written as CSV or shown in a notebook."""

from __future__ import annotations

import csv
import math
import os
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np

from ..notebook import table as html_table

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self


class Table(np.ndarray[Any, np.dtype[Any]]):
    """Rows of numbers and strings: a structured array, which pandas and others accept (`pandas.DataFrame(table)`).

    `table["spot_rms_um"]` is a column, `table[0]` a row, `table[mask]` a table of some rows.
    """

    def __new__(cls, data: ArrayLike) -> Self:
        """Makes a table of a one-dimensional structured array, in the same memory."""
        array = np.asarray(data)
        if array.dtype.names is None or array.ndim != 1:
            raise ValueError(f"a table needs a structured array of one dimension, and not {array.dtype}, {array.shape}")
        return array.view(cls)

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns' names."""
        return self.dtype.names or ()

    def __getitem__(self, which: Any) -> Any:
        """Returns a column by name, a row by number, or a table of some rows by a slice or a mask."""
        found = super().__getitem__(which)
        return found.view(np.ndarray) if isinstance(found, Table) and found.dtype.names is None else found

    def equals(self, other: Table) -> bool:
        """Whether another table has the same columns and values; NaN equals NaN."""
        if self.dtype != other.dtype or len(self) != len(other):
            return False
        return all(
            np.array_equal(self[name], other[name], equal_nan=self[name].dtype.kind == "f") for name in self.columns
        )

    def to_csv(self, file: str | os.PathLike[str] | TextIO) -> None:
        """Writes the table as CSV with a header line. Numbers have full precision; NaN becomes an empty cell."""
        if isinstance(file, (str, os.PathLike)):
            with open(file, "w", encoding="utf-8", newline="") as opened:
                self.to_csv(opened)
            return
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(self.columns)
        for row in self.tolist():
            writer.writerow(["" if isinstance(cell, float) and math.isnan(cell) else cell for cell in row])

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows: {', '.join(self.columns)}>" if self.columns else super().__repr__()

    def _repr_html_(self) -> str:
        """Returns the rows as HTML, for notebooks."""
        return html_table(self.columns, self.tolist())
