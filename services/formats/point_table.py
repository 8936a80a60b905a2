# SPDX-License-Identifier: Apache-2.0
"""What PCD and PLY share: a header of words, then rows of scalars as text or as bytes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError


def header_lines(path: Path, data: bytes, last: str, format_name: str) -> tuple[list[list[str]], int]:
    """The words of each header line up to the one that begins with `last`, and where the data behind it begins.

    Raises InputError where no such line is found.
    """
    lines: list[list[str]] = []
    begin = 0
    while (end := data.find(b"\n", begin)) >= 0:
        words = data[begin:end].decode("ascii", errors="replace").split()
        begin = end + 1
        if words:
            lines.append(words)
            if words[0] == last:
                return lines, begin
    raise InputError(f"{path}: no header that ends with a line '{last}', expected a {format_name} file")


def table_of(
    path: Path, data: bytes, dtype: np.dtype[np.void], count: int, *, ascii_rows: bool
) -> npt.NDArray[np.void]:
    """`count` rows of `dtype` out of the bytes behind a header. Raises InputError where there are fewer."""
    if not ascii_rows:
        if len(data) < count * dtype.itemsize:
            raise InputError(
                f"{path}: cut off, {len(data)} bytes of points, expected {count * dtype.itemsize} for {count} points"
            )
        rows: npt.NDArray[np.void] = np.frombuffer(data, dtype, count)
        return rows
    lines = data.decode("ascii", errors="replace").splitlines()[:count]
    if len(lines) < count:
        raise InputError(f"{path}: cut off, {len(lines)} rows, expected {count} points")
    names = dtype.names or ()
    numbers = [_row(path, number, line.split(), len(names)) for number, line in enumerate(lines, start=1)]
    columns = np.array(numbers, dtype=np.float64).reshape(-1, len(names))
    table = np.empty(count, dtype)
    for column, name in enumerate(names):
        table[name] = _column(path, name, columns[:, column], dtype[name])
    return table


def _row(path: Path, number: int, fields: Sequence[str], count: int) -> list[float]:
    if len(fields) != count:
        raise InputError(f"{path}: point {number} has {len(fields)} numbers, expected {count}")
    try:
        return [float(field) for field in fields]
    except ValueError as error:
        raise InputError(f"{path}: point {number}: {error}") from None


def _column(path: Path, name: str, values: npt.NDArray[np.float64], dtype: np.dtype[Any]) -> npt.NDArray[Any]:
    if dtype.kind == "f":
        with np.errstate(over="ignore"):  # becomes infinite, which whoever needs this column refuses
            return values.astype(dtype)
    limits = np.iinfo(dtype)
    fits = (values == np.rint(values)) & (values >= limits.min) & (values <= limits.max)
    if not fits.all():
        row = int(np.argmin(fits))
        expected = f"a whole number in {limits.min}..{limits.max}"
        raise InputError(f"{path}: {name} {values[row]:g} of point {row + 1}, expected {expected}")
    return values.astype(dtype)
