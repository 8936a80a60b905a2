# SPDX-License-Identifier: Apache-2.0
"""Poses as 4x4 matrices and as (7,) tx ty tz qx qy qz qw."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def pose_from_matrix(matrix: Array) -> Array:
    """(4, 4) rigid transform to (7,), with qw >= 0 so that one pose has one spelling."""
    r = matrix[:3, :3]
    # Shepperd's method: the largest of the four candidates keeps the division well conditioned.
    candidates = np.array([r[0, 0], r[1, 1], r[2, 2], r[0, 0] + r[1, 1] + r[2, 2]])
    choice = int(np.argmax(candidates))
    q = np.empty(4)
    if choice == 3:
        q[:] = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], 1.0 + candidates[3]
    else:
        i, j, k = choice, (choice + 1) % 3, (choice + 2) % 3
        q[i] = 1.0 + 2.0 * r[i, i] - candidates[3]
        q[j], q[k], q[3] = r[j, i] + r[i, j], r[k, i] + r[i, k], r[k, j] - r[j, k]
    q /= np.linalg.norm(q)
    return np.concatenate((matrix[:3, 3], q if q[3] >= 0 else -q))


def matrix_from_pose(pose: Array) -> Array:
    """(7,) to a (4, 4) rigid transform. Raises ValueError for a quaternion without length."""
    quaternion = np.asarray(pose[3:7], dtype=np.float64)
    norm = float(np.linalg.norm(quaternion))
    if not norm > 0:
        raise ValueError(f"quaternion {quaternion.tolist()} has no length, expected a unit quaternion")
    x, y, z, w = quaternion / norm
    matrix = np.eye(4)
    matrix[:3, :3] = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    matrix[:3, 3] = pose[:3]
    return matrix
