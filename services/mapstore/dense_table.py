# SPDX-License-Identifier: Apache-2.0
"""Semi-dense maps in the map's file: one row a keyframe, its points as blobs of little-endian columns."""

import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from schemas.records import MapUpdate

REPLACE_CLOUD = "INSERT OR REPLACE INTO dense_keyframes VALUES (?,?, ?,?,?,?,?,?)"
_COLUMNS = {
    "position": "<f4",
    "depth_sigma": "<f4",
    "grey": "u1",
    "state": "u1",
    "category": "<i2",
    "object_id": "<u4",
}


@dataclass(frozen=True)
class DenseCloud:
    """One keyframe's points in its camera frame and units; arrays are parallel."""

    keyframe_id: int
    position: npt.NDArray[np.float32]
    """(N, 3)"""
    depth_sigma: npt.NDArray[np.float32]
    """standard deviation along the optical axis"""
    grey: npt.NDArray[np.uint8]
    state: npt.NDArray[np.uint8]
    category: npt.NDArray[np.int16]
    object_id: npt.NDArray[np.uint32]


def cloud_rows(update: MapUpdate) -> Iterator[tuple[Any, ...]]:
    """Rows for REPLACE_CLOUD."""
    columns = [getattr(update, f"dense_point_{name}").astype(kind, copy=False) for name, kind in _COLUMNS.items()]
    start = 0
    for number, count in zip(update.dense_keyframe_id.tolist(), update.dense_keyframe_points.tolist(), strict=True):
        yield (number, count, *(column[start : start + count].tobytes() for column in columns))
        start += count


def point_counts(connection: sqlite3.Connection) -> dict[int, int]:
    """Points of each keyframe that has a semi-dense map."""
    if not _has_clouds(connection):
        return {}
    return dict(connection.execute("SELECT keyframe_id, points FROM dense_keyframes"))


def read_clouds(connection: sqlite3.Connection) -> Iterator[DenseCloud]:
    """All clouds by keyframe id, one after the other, so that a large map is never in memory at once."""
    if not _has_clouds(connection):
        return
    for number, count, *blobs in connection.execute("SELECT * FROM dense_keyframes ORDER BY keyframe_id"):
        columns = [np.frombuffer(blob, kind) for blob, kind in zip(blobs, _COLUMNS.values(), strict=True)]
        yield DenseCloud(number, columns[0].reshape(count, 3), *columns[1:])


def _has_clouds(connection: sqlite3.Connection) -> bool:
    """A map of version 1 that is only read has no such table."""
    query = "SELECT count(*) FROM sqlite_schema WHERE name = 'dense_keyframes'"
    return bool(connection.execute(query).fetchone()[0])
