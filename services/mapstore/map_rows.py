# SPDX-License-Identifier: Apache-2.0
"""Records as rows of the map's tables, and back."""

import math
import sqlite3
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from schemas.records import Density, DensityLevel, MapUpdate, MaskSource, TrackedFrame, TrackingState

UPSERT_KEYFRAME = """
INSERT INTO keyframes VALUES (?,?,?, ?,?,?,?,?,?,?,?, ?,?)
ON CONFLICT (id) DO UPDATE SET timestamp_ns = excluded.timestamp_ns, map_id = excluded.map_id,
    tx = excluded.tx, ty = excluded.ty, tz = excluded.tz, qx = excluded.qx, qy = excluded.qy, qz = excluded.qz,
    qw = excluded.qw, scale = excluded.scale, culled = excluded.culled, parent_id = excluded.parent_id
"""
UPSERT_LANDMARK = """
INSERT INTO landmarks VALUES (?,?, ?,?,?, ?,?,?,?,?,?)
ON CONFLICT (id) DO UPDATE SET anchor_id = excluded.anchor_id, x = excluded.x, y = excluded.y, z = excluded.z,
    state = excluded.state, category = excluded.category, object_id = excluded.object_id,
    first_seen_ns = excluded.first_seen_ns, last_seen_ns = excluded.last_seen_ns,
    valid_until_ns = excluded.valid_until_ns
"""
BURY_LANDMARK = "INSERT OR REPLACE INTO removed_landmarks VALUES (?, ?)"
DELETE_LANDMARK = "DELETE FROM landmarks WHERE id = ?"
INSERT_FRAME = "INSERT INTO frames VALUES (?,?,?,?,?,?,?, ?,?,?,?,?,?,?, ?,?,?,?,?,?,?)"
CORRECT_FRAME = """
UPDATE frames SET reference_keyframe_id = ?, map_id = ?,
    ref_tx = ?, ref_ty = ?, ref_tz = ?, ref_qx = ?, ref_qy = ?, ref_qz = ?, ref_qw = ?
WHERE sequence = (SELECT max(sequence) FROM frames WHERE timestamp_ns = ?)
"""
INSERT_DENSITY = "INSERT INTO densities VALUES (?, ?,?,?, ?,?, ?,?,?, ?,?)"
REPLACE_PROGRESS = "INSERT OR REPLACE INTO progress VALUES (1, ?, ?, ?, ?, ?)"

NO_KEYFRAME = -1
_NO_POSE = (None,) * 7
_FLOATS = ("f4", "f8")
_KEYFRAME = {
    "id": ("i8", ("id",)),
    "timestamp_ns": ("i8", ("timestamp_ns",)),
    "map_id": ("i8", ("map_id",)),
    "pose": ("f8", ("tx", "ty", "tz", "qx", "qy", "qz", "qw", "scale")),
    "culled": ("u1", ("culled",)),
    "parent_id": ("i8", ("parent_id",)),
}
"""MapUpdate's keyframe arrays: element type, and the columns of a row"""
_LANDMARK = {
    "id": ("i8", ("id",)),
    "anchor_id": ("i8", ("anchor_id",)),
    "position": ("f4", ("x", "y", "z")),
    "state": ("u1", ("state",)),
    "category": ("i4", ("category",)),
    "object_id": ("u4", ("object_id",)),
    "first_seen_ns": ("i8", ("first_seen_ns",)),
    "last_seen_ns": ("i8", ("last_seen_ns",)),
    "valid_until_ns": ("i8", ("valid_until_ns",)),
}
"""the same of landmarks"""


def keyframe_rows(update: MapUpdate) -> Iterable[tuple[Any, ...]]:
    """Rows for UPSERT_KEYFRAME."""
    return zip(
        update.keyframe_id.tolist(),
        update.keyframe_timestamp_ns.tolist(),
        update.keyframe_map_id.tolist(),
        *(column.tolist() for column in update.keyframe_pose.T),
        update.keyframe_culled.tolist(),
        update.keyframe_parent_id.tolist(),
        strict=True,
    )


def landmark_rows(update: MapUpdate) -> Iterable[tuple[Any, ...]]:
    """Rows for UPSERT_LANDMARK."""
    return zip(
        update.landmark_id.tolist(),
        update.landmark_anchor_id.tolist(),
        *(column.tolist() for column in update.landmark_position.T),
        update.landmark_state.tolist(),
        update.landmark_category.tolist(),
        update.landmark_object_id.tolist(),
        update.landmark_first_seen_ns.tolist(),
        update.landmark_last_seen_ns.tolist(),
        update.landmark_valid_until_ns.tolist(),
        strict=True,
    )


def correction_rows(update: MapUpdate) -> Iterable[tuple[Any, ...]]:
    """Rows for CORRECT_FRAME."""
    return (
        (keyframe_id, update.map_id, *pose, timestamp_ns)
        for timestamp_ns, keyframe_id, pose in zip(
            update.frame_timestamp_ns.tolist(),
            update.frame_reference_keyframe_id.tolist(),
            update.frame_camera_from_reference.tolist(),
            strict=True,
        )
    )


def frame_row(sequence: int, frame: TrackedFrame) -> tuple[Any, ...]:
    """The row for INSERT_FRAME."""
    relative, live = frame.camera_from_reference, frame.map_from_camera
    return (
        sequence,
        frame.timestamp_ns,
        int(frame.state),
        frame.reason,
        frame.handling,
        frame.map_id,
        NO_KEYFRAME if relative is None else frame.reference_keyframe_id,
        *(_NO_POSE if relative is None else relative.tolist()),
        *(_NO_POSE if live is None else live.tolist()),
    )


def frame_of(row: tuple[Any, ...], metric_scale: bool) -> TrackedFrame:
    """The frame of a row of `frames`, with what the map keeps of it."""
    _, timestamp_ns, state, reason, handling, map_id, reference_id = row[:7]
    relative, live = row[7:14], row[14:21]
    return TrackedFrame(
        timestamp_ns,
        TrackingState(state),
        reason,
        map_id,
        None if live[0] is None else np.array(live, dtype=np.float64),
        None,
        reference_id,
        None if relative[0] is None else np.array(relative, dtype=np.float64),
        features=0,
        tracked_landmarks=0,
        keyframe_inserted=False,
        masks=MaskSource.NO_MASKS,
        metric_scale=metric_scale,
        handling=handling,
    )


def density_row(sequence: int, density: Density) -> tuple[Any, ...]:
    """The row for INSERT_DENSITY; SQLite keeps NaN as NULL."""
    return (
        sequence,
        *density.position,
        density.radius,
        None if math.isinf(density.window_s) else density.window_s,
        density.moving_points,
        density.moving_objects,
        density.observed_points,
        int(density.level),
        int(density.metric_scale),
    )


def density_of(timestamp_ns: int, row: tuple[Any, ...]) -> Density:
    """The Density of a row of `densities`, the same as was written."""
    x, y, z = (math.nan if value is None else value for value in row[1:4])
    radius, window_s, points, objects, observed, level, metric = row[4:]
    window_s = math.inf if window_s is None else window_s
    return Density(
        timestamp_ns, (x, y, z), radius, window_s, points, objects, observed, DensityLevel(level), bool(metric)
    )


def update_of(connection: sqlite3.Connection) -> MapUpdate:
    """The whole map as one update."""
    keyframes = _rows(connection, "keyframes", _KEYFRAME)
    landmarks = _rows(connection, "landmarks", _LANDMARK)
    columns: dict[str, Any] = {f"keyframe_{name}": keyframes[name] for name in _KEYFRAME}
    columns |= {f"landmark_{name}": landmarks[name] for name in _LANDMARK}
    return MapUpdate(timestamp_ns=0, **columns)


def _rows(
    connection: sqlite3.Connection, table: str, layout: dict[str, tuple[str, tuple[str, ...]]]
) -> npt.NDArray[np.void]:
    """A table as a structured array, row by row from the cursor: a large map is never in memory as Python objects.

    What is not finite comes back as NaN; SQLite keeps NaN as NULL.
    """
    flat = [(column, kind) for kind, columns in layout.values() for column in columns]
    names = ", ".join(f"ifnull({column}, 9e999)" if kind in _FLOATS else column for column, kind in flat)
    cursor = connection.execute(f"SELECT {names} FROM {table} ORDER BY id")
    rows = np.fromiter(cursor, dtype=np.dtype(flat))
    for column, kind in flat:
        if kind in _FLOATS:
            rows[column][np.isinf(rows[column])] = np.nan
    grouped = [
        (name, kind, (len(columns),)) if len(columns) > 1 else (name, kind) for name, (kind, columns) in layout.items()
    ]
    return rows.view(np.dtype(grouped))
