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
    keyframes = _numbers(connection, "SELECT * FROM keyframes ORDER BY id", 13)
    landmarks = _numbers(connection, "SELECT * FROM landmarks ORDER BY id", 11)
    return MapUpdate(
        timestamp_ns=0,
        keyframe_id=_integers(keyframes[0]),
        keyframe_timestamp_ns=_integers(keyframes[1]),
        keyframe_map_id=_integers(keyframes[2]),
        keyframe_pose=_floats(keyframes[3:11]),
        keyframe_culled=_integers(keyframes[11]).astype(np.uint8),
        keyframe_parent_id=_integers(keyframes[12]),
        landmark_id=_integers(landmarks[0]),
        landmark_anchor_id=_integers(landmarks[1]),
        landmark_position=_floats(landmarks[2:5]).astype(np.float32),
        landmark_state=_integers(landmarks[5]).astype(np.uint8),
        landmark_category=_integers(landmarks[6]).astype(np.int32),
        landmark_object_id=_integers(landmarks[7]).astype(np.uint32),
        landmark_first_seen_ns=_integers(landmarks[8]),
        landmark_last_seen_ns=_integers(landmarks[9]),
        landmark_valid_until_ns=_integers(landmarks[10]),
    )


def _numbers(connection: sqlite3.Connection, query: str, columns: int) -> list[tuple[Any, ...]]:
    rows = connection.execute(query).fetchall()
    return list(zip(*rows, strict=True)) if rows else [()] * columns


def _integers(column: tuple[Any, ...]) -> npt.NDArray[np.int64]:
    return np.array(column, dtype=np.int64)


def _floats(columns: list[tuple[Any, ...]]) -> npt.NDArray[np.float64]:
    return np.array(columns, dtype=np.float64).T.reshape(-1, len(columns))
