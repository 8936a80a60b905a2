# SPDX-License-Identifier: Apache-2.0
"""Trajectories as the TUM RGB-D benchmark writes them: `timestamp_s tx ty tz qx qy qz qw`, one line a pose."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import pose_from_matrix
from services.formats.pose_rows import pose_matrix, read_pose_rows, reals, seconds_as_ns
from services.formats.text_rows import TextRow
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

COLUMNS = 8


def read_tum(path: Path) -> Trajectory:
    """world_from_camera, metres, of every row. Raises InputError naming file, line and value."""
    return tum_rows(path, read_pose_rows(path, "a trajectory in TUM format"))


def tum_rows(path: Path, rows: list[TextRow]) -> Trajectory:
    """The trajectory in rows already read from `path`. Raises InputError naming file, line and value."""
    if len(rows[0].fields) != COLUMNS:
        raise InputError(f"{path}:{rows[0].line}: {len(rows[0].fields)} numbers, expected {COLUMNS} (TUM)")
    times = np.array([seconds_as_ns(row) for row in rows], dtype=np.int64)
    return Trajectory(times, np.array([_pose(row) for row in rows]), str(path))


def write_tum(trajectory: Trajectory, path: Path) -> None:
    """Write TUM rows; nanoseconds are kept exactly, positions and quaternions to nine digits, qw >= 0."""
    with path.open("w", encoding="ascii") as file:
        for time_ns, pose in zip(trajectory.timestamp_ns.tolist(), trajectory.world_from_camera, strict=True):
            values = " ".join(f"{value:.9f}" for value in pose_from_matrix(pose))
            file.write(f"{time_ns // 1_000_000_000}.{time_ns % 1_000_000_000:09d} {values}\n")


def _pose(row: TextRow) -> npt.NDArray[np.float64]:
    return pose_matrix(row, reals(row, "tx ty tz", 1), reals(row, "qx qy qz qw", 4))
