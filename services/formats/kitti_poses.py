# SPDX-License-Identifier: Apache-2.0
"""Trajectories as the KITTI odometry benchmark writes them: 3x4 row-major, one line a frame, times in another file."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.formats.pose_rows import read_pose_rows, reals, seconds_as_ns
from services.formats.text_rows import TextRow
from services.formats.trajectory import Trajectory, period_ns
from services.runtime.errors import InputError

COLUMNS = 12
TIMES_NAME = "times.txt"
_NAMES = "r11 r12 r13 tx r21 r22 r23 ty r31 r32 r33 tz"


def read_kitti_poses(path: Path, times: Path | None = None, rate_hz: float | None = None) -> Trajectory:
    """world_from_camera of camera 0, metres, one pose a row.

    The times come from `times` (seconds, one a line), else from `rate_hz`, else from a `times.txt` beside the file.
    Raises InputError naming file, line and value.
    """
    return kitti_rows(path, read_pose_rows(path, "a trajectory in KITTI format"), times, rate_hz)


def kitti_rows(path: Path, rows: list[TextRow], times: Path | None = None, rate_hz: float | None = None) -> Trajectory:
    """The trajectory in rows already read from `path`. Raises InputError naming file, line and value."""
    if len(rows[0].fields) != COLUMNS:
        raise InputError(f"{path}:{rows[0].line}: {len(rows[0].fields)} numbers, expected {COLUMNS} (KITTI)")
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, :] = np.array([reals(row, _NAMES, 0) for row in rows]).reshape(-1, 3, 4)
    return Trajectory(_times(path, len(rows), times, rate_hz), poses, str(path))


def write_kitti_poses(trajectory: Trajectory, path: Path) -> None:
    """Write the upper 3x4 of world_from_camera, row-major; times go into another file (`write_times`)."""
    np.savetxt(path, trajectory.world_from_camera[:, :3, :].reshape(-1, COLUMNS), fmt="%.9e")


def read_times(path: Path) -> npt.NDArray[np.int64]:
    """(N,) nanoseconds of a file of seconds. Raises InputError naming file, line and value."""
    rows = read_pose_rows(path, "times in seconds, one a line")
    return np.array([seconds_as_ns(row) for row in rows], dtype=np.int64)


def write_times(timestamp_ns: npt.NDArray[np.int64], path: Path) -> None:
    """Seconds since the first pose, one a line, as KITTI has them."""
    seconds = (timestamp_ns - timestamp_ns[:1]) / 1e9
    np.savetxt(path, seconds, fmt="%.9e")


def _times(path: Path, count: int, times: Path | None, rate_hz: float | None) -> npt.NDArray[np.int64]:
    if times is None and rate_hz is not None:
        stamps: npt.NDArray[np.int64] = np.rint(np.arange(count) * period_ns(rate_hz)).astype(np.int64)
        return stamps
    if times is None:
        times = path.parent / TIMES_NAME
        if not times.is_file():
            raise InputError(f"{path}: KITTI poses hold no times, expected --times with a file of them or --rate in Hz")
    found = read_times(times)
    if len(found) < count:
        raise InputError(f"{times}: {len(found)} times for the {count} poses of {path}, expected one for each")
    return found[:count]
