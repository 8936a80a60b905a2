# SPDX-License-Identifier: Apache-2.0
"""Where a KITTI car really was: its inertial and GPS unit's rows as poses, and how the cameras sit on the unit.

Source: Geiger et al., "Vision meets Robotics: The KITTI Dataset", IJRR 2013; the raw data development kit
(convertOxtsToPose: Mercator projection, scaled at the first latitude).
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.number_rows import parse_numbers
from services.runtime.errors import InputError

COLUMNS = 30
"""numbers a row; the first six are latitude and longitude (degrees), altitude (m), roll, pitch, yaw (radians)"""
_EARTH_RADIUS_M = 6378137.0
Array = npt.NDArray[np.float64]


def imu_poses(rows: Array) -> Array:
    """(N, 4, 4) first_imu_from_imu in metres (x forward, y left, z up) of (N, 6) rows: the world is the first pose."""
    latitude, longitude = np.radians(rows[:, 0]), np.radians(rows[:, 1])
    scale = np.cos(latitude[0])
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, 0, 3] = scale * _EARTH_RADIUS_M * longitude
    poses[:, 1, 3] = scale * _EARTH_RADIUS_M * np.log(np.tan(np.pi / 4 + latitude / 2))
    poses[:, 2, 3] = rows[:, 2]
    poses[:, :3, :3] = _about(2, rows[:, 5]) @ _about(1, rows[:, 4]) @ _about(0, rows[:, 3])
    return np.linalg.inv(poses[0]) @ poses


def world_from_camera(rows: Array, camera_0_from_imu: Array, camera_0_from_camera: Array) -> Array:
    """(N, 4, 4) in metres; the world is the first frame's rectified camera 0, as in KITTI's odometry benchmark."""
    poses: Array = camera_0_from_imu @ imu_poses(rows) @ np.linalg.inv(camera_0_from_imu) @ camera_0_from_camera
    return poses


def parse_oxts(path: Path, line_number: int, line: str) -> list[float]:
    """The first six numbers of a row of 30.

    Raises:
        InputError: another count, no numbers, a latitude that is none; names file, line, found and expected.
    """
    numbers = parse_numbers(path, line_number, line, COLUMNS)[:6]
    if not abs(numbers[0]) < 90:
        raise InputError(f"{path} line {line_number}: latitude {numbers[0]:g}, expected one between -90 and 90 degrees")
    return numbers


def _about(axis: int, angles: Array) -> Array:
    """(N, 3, 3) rotations about x (0), y (1) or z (2)."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    rotations = np.tile(np.eye(3), (len(angles), 1, 1))
    rotations[:, one, one] = rotations[:, other, other] = np.cos(angles)
    rotations[:, other, one] = np.sin(angles)
    rotations[:, one, other] = -np.sin(angles)
    return rotations
