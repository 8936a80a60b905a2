# SPDX-License-Identifier: Apache-2.0
"""Which of the trajectory formats a file has."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.formats import euroc, kitti_poses, tum
from services.formats.pose_rows import read_pose_rows
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


def read_trajectory(
    path: Path,
    times: Path | None = None,
    rate_hz: float | None = None,
    body_from_sensor: npt.NDArray[np.float64] | None = None,
) -> Trajectory:
    """Read a trajectory whose format is told by its columns: 12 are KITTI, 17 are EuRoC, 8 are EuRoC in a file whose
    name ends in .csv and TUM in others.

    `times` and `rate_hz` are for KITTI, which holds no times (`read_kitti_poses`); `body_from_sensor` (4, 4) is for
    EuRoC, whose poses are the body's. Raises InputError for a file that is missing, empty or none of these.
    """
    rows = read_pose_rows(path, "a trajectory in TUM, KITTI or EuRoC format")
    columns = len(rows[0].fields)
    if columns == euroc.STATE_COLUMNS or (columns == euroc.POSE_COLUMNS and path.suffix.lower() == ".csv"):
        return euroc.euroc_rows(path, rows, body_from_sensor)
    if body_from_sensor is not None:
        raise InputError(f"{path}: T_BS of a sensor is for EuRoC's poses of the body, expected an EuRoC .csv with it")
    if columns == tum.COLUMNS:
        return tum.tum_rows(path, rows)
    if columns == kitti_poses.COLUMNS:
        return kitti_poses.kitti_rows(path, rows, times, rate_hz)
    raise InputError(f"{path}:{rows[0].line}: {columns} numbers, expected 8 (TUM), 12 (KITTI) or 8 or 17 (EuRoC .csv)")
