# SPDX-License-Identifier: Apache-2.0
"""What the text formats of trajectories share: rows of numbers, times in seconds, unit quaternions."""

import math
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose
from services.formats.text_rows import TextRow, read_rows
from services.runtime.errors import InputError

_NS_PER_S = Decimal(1_000_000_000)
_LATEST_S = 2**33
_LENGTH_TOLERANCE = 0.01


def read_pose_rows(path: Path, expected: str) -> list[TextRow]:
    """The rows that are no comments (#), commas or blanks between the fields, all of one length and one at least.

    Raises InputError otherwise, and for a file that is missing or no text; it says what was `expected` in it.
    """
    rows = [
        TextRow(row.path, row.line, tuple(piece for field in row.fields for piece in field.split(",") if piece))
        for row in read_rows(path, expected)
        if not row.fields[0].startswith("#")
    ]
    if not rows:
        raise InputError(f"{path}: holds no rows, expected {expected}")
    columns = len(rows[0].fields)
    for row in rows:
        if len(row.fields) != columns:
            raise InputError(f"{path}:{row.line}: {len(row.fields)} numbers, expected {columns} as in the first row")
    return rows


def seconds_as_ns(row: TextRow) -> int:
    """The first field, seconds, as nanoseconds: exactly, since Unix time in ns fits no float. Raises InputError."""
    try:
        seconds = Decimal(row.fields[0])
        if seconds.is_finite() and abs(seconds) < _LATEST_S:
            return int((seconds * _NS_PER_S).to_integral_value())
    except InvalidOperation:
        pass  # said below, as for a number that is no time
    raise row.error("time", row.fields[0], "seconds")


def reals(row: TextRow, names: str, first: int) -> list[float]:
    """The fields from `first` on, one for each of the blank-separated `names`. Raises InputError for one not finite."""
    return [row.real(first + offset, name) for offset, name in enumerate(names.split())]


def pose_matrix(row: TextRow, position: list[float], quaternion_xyzw: list[float]) -> npt.NDArray[np.float64]:
    """(4, 4). Raises InputError for a quaternion whose length is not 1 within a percent."""
    length = math.hypot(*quaternion_xyzw)
    if abs(length - 1.0) > _LENGTH_TOLERANCE:
        raise InputError(f"{row.path}:{row.line}: quaternion of length {length:.3g}, expected 1")
    return matrix_from_pose(np.array([*position, *quaternion_xyzw]))
