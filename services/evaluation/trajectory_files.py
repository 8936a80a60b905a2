# SPDX-License-Identifier: Apache-2.0
"""Trajectories as text: TUM (`timestamp_s tx ty tz qx qy qz qw`) and KITTI (3x4 row-major, one line a frame)."""

from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory import Trajectory
from services.runtime.errors import InputError

_NS = Decimal(1_000_000_000)


def read_trajectory(path: Path, times: Path | None = None, rate_hz: float | None = None) -> Trajectory:
    """Read a trajectory whose format is told by its columns: 8 are TUM, 12 are KITTI.

    KITTI holds no times: they come from `times` (seconds, one a line), else from `rate_hz`, else from a `times.txt`
    beside the file. Raises InputError for a file that is missing, empty or neither, or holds NaN.
    """
    rows = _read_rows(path)
    columns = len(rows[0][1])
    if columns == 8:
        return _from_tum(path, rows)
    if columns == 12:
        return _from_kitti(path, rows, times, rate_hz)
    raise InputError(f"{path}:{rows[0][0]}: {columns} numbers, expected 8 (TUM) or 12 (KITTI)")


def write_tum(trajectory: Trajectory, path: Path) -> None:
    """Write TUM rows; nanoseconds are kept exactly."""
    quaternions = Rotation.from_matrix(trajectory.world_from_camera[:, :3, :3]).as_quat(canonical=True)
    with path.open("w", encoding="ascii") as file:
        for time_ns, position, quaternion in zip(
            trajectory.timestamp_ns.tolist(), trajectory.positions_m, quaternions, strict=True
        ):
            numbers = " ".join(f"{value:.9f}" for value in (*position, *quaternion))
            file.write(f"{time_ns // 1_000_000_000}.{time_ns % 1_000_000_000:09d} {numbers}\n")


def write_kitti(trajectory: Trajectory, path: Path) -> None:
    """Write KITTI rows: world_from_camera, the upper 3x4, row-major."""
    np.savetxt(path, trajectory.world_from_camera[:, :3, :].reshape(-1, 12), fmt="%.9e")


def _read_rows(path: Path) -> list[tuple[int, list[str]]]:
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file, expected a trajectory in TUM or KITTI format") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a readable text file ({error.__class__.__name__})") from None
    rows = [
        (number, line.replace(",", " ").split())
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not rows:
        raise InputError(f"{path}: holds no poses, expected a trajectory in TUM or KITTI format")
    columns = len(rows[0][1])
    for number, fields in rows:
        if len(fields) != columns:
            raise InputError(f"{path}:{number}: {len(fields)} numbers, expected {columns} as in the first row")
    return rows


def _numbers(path: Path, number: int, fields: list[str]) -> list[float]:
    values = []
    for field in fields:
        try:
            values.append(float(field))
        except ValueError:
            raise InputError(f"{path}:{number}: '{field}' is not a number") from None
        if not np.isfinite(values[-1]):
            raise InputError(f"{path}:{number}: '{field}' in a pose, expected finite numbers")
    return values


def _time_ns(path: Path, number: int, field: str) -> int:
    try:
        seconds = Decimal(field)
        if seconds.is_finite() and abs(seconds) < 2**33:
            return int((seconds * _NS).to_integral_value())
    except InvalidOperation:
        pass  # said below, as for a number that is no time
    raise InputError(f"{path}:{number}: '{field}' is not a time in seconds")


def _from_tum(path: Path, rows: list[tuple[int, list[str]]]) -> Trajectory:
    times = np.array([_time_ns(path, number, fields[0]) for number, fields in rows], dtype=np.int64)
    values = np.array([_numbers(path, number, fields[1:]) for number, fields in rows])
    lengths = np.linalg.norm(values[:, 3:], axis=1)
    off = np.abs(lengths - 1.0) > 0.01
    if off.any():
        row = int(np.argmax(off))
        raise InputError(f"{path}:{rows[row][0]}: quaternion of length {lengths[row]:.3g}, expected 1")
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, :3] = Rotation.from_quat(values[:, 3:]).as_matrix()
    poses[:, :3, 3] = values[:, :3]
    return Trajectory(times, poses, str(path))


def _from_kitti(path: Path, rows: list[tuple[int, list[str]]], times: Path | None, rate_hz: float | None) -> Trajectory:
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, :] = np.array([_numbers(path, number, fields) for number, fields in rows]).reshape(-1, 3, 4)
    return Trajectory(_kitti_times(path, len(rows), times, rate_hz), poses, str(path))


def _kitti_times(path: Path, count: int, times: Path | None, rate_hz: float | None) -> npt.NDArray[np.int64]:
    if times is None and rate_hz is not None:
        if not (np.isfinite(rate_hz) and rate_hz > 0.0):
            raise InputError(f"rate {rate_hz} Hz, expected a number above 0")
        stamps: npt.NDArray[np.int64] = np.rint(np.arange(count) * (1e9 / rate_hz)).astype(np.int64)
        return stamps
    if times is None:
        times = path.parent / "times.txt"
        if not times.is_file():
            raise InputError(f"{path}: KITTI poses hold no times; give a times file or a rate in Hz")
    rows = _read_rows(times)
    if len(rows) < count:
        raise InputError(f"{times}: {len(rows)} times for the {count} poses of {path}")
    return np.array([_time_ns(times, number, fields[0]) for number, fields in rows[:count]], dtype=np.int64)
