# SPDX-License-Identifier: Apache-2.0
"""Columns that grow together and can be looked at while they do."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[Any]


class GrowingTable:
    """Rows of numpy columns, appended in amortised constant time.

    A snapshot costs nothing and never changes: rows after it are only appended, and the first write to an old row after
    a snapshot copies the columns it writes to.
    """

    def __init__(self, **columns: npt.NDArray[Any]) -> None:
        """`columns`: one empty array a column, shape (0, ...), whose dtype and row shape the column keeps."""
        self._columns: dict[str, Column] = dict(columns)
        self._seen: set[str] = set()
        self._rows = 0

    def __len__(self) -> int:
        return self._rows

    def __getitem__(self, column: str) -> Column:
        """The live rows of a column, to read."""
        return self._columns[column][: self._rows]

    def append(self, count: int, values: Mapping[str, npt.ArrayLike]) -> npt.NDArray[np.intp]:
        """Adds `count` rows, zero where `values` has no such column, and returns their indices."""
        start, self._rows = self._rows, self._rows + count
        for name in self._columns:
            self._make_room(name, start)
            if name in values:
                self._columns[name][start : self._rows] = values[name]
        return np.arange(start, self._rows)

    def write(self, rows: npt.NDArray[np.intp], values: Mapping[str, npt.ArrayLike]) -> None:
        """Sets columns of existing rows; where a row is named twice the last value holds."""
        if len(rows) == 0:
            return
        for name, value in values.items():
            if name in self._seen:
                self._columns[name] = self._columns[name].copy()
                self._seen.discard(name)
            self._columns[name][rows] = value

    def snapshot(self, *names: str) -> dict[str, Column]:
        """The named columns as they are now and stay."""
        self._seen.update(names)
        columns = {name: self._columns[name][: self._rows] for name in names}
        for column in columns.values():
            column.flags.writeable = False
        return columns

    def _make_room(self, name: str, filled: int) -> None:
        column = self._columns[name]
        if self._rows > len(column):
            grown = np.zeros((max(self._rows, 2 * len(column), 64), *column.shape[1:]), dtype=column.dtype)
            grown[:filled] = column[:filled]
            self._columns[name] = grown
            self._seen.discard(name)
