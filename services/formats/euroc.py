# SPDX-License-Identifier: Apache-2.0
"""Trajectories as the EuRoC MAV data sets write them: `timestamp_ns, position, quaternion w x y z`, by commas.

Burri et al., "The EuRoC micro aerial vehicle datasets", IJRR 2016. The poses of state_groundtruth_estimate0 are the
body's, world_from_body; a camera's own file (cam0/sensor.yaml) says how it sits on the body (T_BS, body_from_sensor).
"""

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import pose_from_matrix
from services.formats.pose_rows import pose_matrix, read_pose_rows, reals
from services.formats.text_rows import TextRow
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

POSE_COLUMNS = 8
STATE_COLUMNS = 17
"""pose, then velocity and the biases of gyroscope and accelerometer, which no trajectory holds"""

_HEADER = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
_BODY_FROM_SENSOR = re.compile(r"^T_BS\s*:(?P<matrix>.*?)\bdata\s*:\s*\[(?P<data>[^\]]*)\]", re.MULTILINE | re.DOTALL)


def read_euroc(path: Path, body_from_sensor: npt.NDArray[np.float64] | None = None) -> Trajectory:
    """world_from_body of every row, or world_from_sensor where `body_from_sensor` (4, 4) is given; metres.

    Raises InputError naming file, line and value.
    """
    return euroc_rows(path, read_pose_rows(path, "a trajectory in EuRoC format"), body_from_sensor)


def euroc_rows(path: Path, rows: list[TextRow], body_from_sensor: npt.NDArray[np.float64] | None = None) -> Trajectory:
    """The trajectory in rows already read from `path`. Raises InputError naming file, line and value."""
    columns = len(rows[0].fields)
    if columns not in (POSE_COLUMNS, STATE_COLUMNS):
        raise InputError(
            f"{path}:{rows[0].line}: {columns} numbers, expected {POSE_COLUMNS} or {STATE_COLUMNS} (EuRoC)"
        )
    times = np.array([_time_ns(row) for row in rows], dtype=np.int64)
    poses = np.array([_pose(row) for row in rows])
    if body_from_sensor is not None:
        poses = poses @ body_from_sensor
    return Trajectory(times, poses, str(path))


def write_euroc(trajectory: Trajectory, path: Path) -> None:
    """Write the eight columns of a pose, qw >= 0, under EuRoC's own header."""
    with path.open("w", encoding="ascii") as file:
        file.write(_HEADER)
        for time_ns, matrix in zip(trajectory.timestamp_ns.tolist(), trajectory.world_from_camera, strict=True):
            x, y, z, qx, qy, qz, qw = pose_from_matrix(matrix)
            values = ",".join(f"{value:.9f}" for value in (x, y, z, qw, qx, qy, qz))
            file.write(f"{time_ns},{values}\n")


def read_body_from_sensor(path: Path) -> npt.NDArray[np.float64]:
    """T_BS (4, 4) of a sensor.yaml. Raises InputError where there is none or it is no rigid transform."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error.__class__.__name__}), expected a sensor.yaml") from None
    found = _BODY_FROM_SENSOR.search(text)
    if found is None:
        raise InputError(f"{path}: holds no T_BS with data: [...], expected a sensor.yaml of EuRoC")
    try:
        values = np.array([float(field) for field in found["data"].replace(",", " ").split()])
    except ValueError as error:
        raise InputError(f"{path}: T_BS holds what is no number ({error})") from None
    if values.shape != (16,):
        raise InputError(f"{path}: T_BS has {len(values)} numbers, expected 16 (4x4, row-major)")
    matrix = values.reshape(4, 4)
    rotation = matrix[:3, :3]
    rigid = np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-3) and np.allclose(matrix[3], (0, 0, 0, 1))
    if not (rigid and np.linalg.det(rotation) > 0.0):
        raise InputError(f"{path}: T_BS is not a rigid transform, expected a rotation, a translation and 0 0 0 1")
    return matrix


def _time_ns(row: TextRow) -> int:
    field = row.fields[0]
    if not re.fullmatch(r"\d{1,19}", field) or int(field) >= 2**63:
        raise row.error("time", field, "whole nanoseconds (EuRoC)")
    return int(field)


def _pose(row: TextRow) -> npt.NDArray[np.float64]:
    w, x, y, z = reals(row, "qw qx qy qz", 4)
    return pose_matrix(row, reals(row, "px py pz", 1), [x, y, z, w])
