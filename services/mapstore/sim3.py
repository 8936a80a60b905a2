# SPDX-License-Identifier: Apache-2.0
"""Similarity transforms of many rows at once.

A Sim(3) row is (8,) tx ty tz qx qy qz qw scale and maps x to scale * R(q) x + t; a pose row (7,) has scale 1.
Quaternions are Hamilton's, scalar last, and need not be normalised to the last bit.
"""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def normalized(quaternion: Floats) -> Floats:
    """(..., 4) at unit length with qw >= 0, so that one rotation has one spelling."""
    unit: Floats = quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True)
    return np.where(unit[..., 3:] < 0, -unit, unit)


def conjugate(quaternion: Floats) -> Floats:
    """(..., 4) the inverse rotation of a unit quaternion."""
    inverse: Floats = quaternion * np.array([-1.0, -1.0, -1.0, 1.0])
    return inverse


def multiply(left: Floats, right: Floats) -> Floats:
    """(..., 4) the rotation `left` after `right`."""
    lv, lw = left[..., :3], left[..., 3:]
    rv, rw = right[..., :3], right[..., 3:]
    vector = lw * rv + rw * lv + cross(lv, rv)
    return np.concatenate([vector, lw * rw - np.sum(lv * rv, axis=-1, keepdims=True)], axis=-1)


def cross(left: Floats, right: Floats) -> Floats:
    """(..., 3) cross products; numpy's own takes twice as long for few rows."""
    lx, ly, lz = left[..., 0], left[..., 1], left[..., 2]
    rx, ry, rz = right[..., 0], right[..., 1], right[..., 2]
    return np.stack([ly * rz - lz * ry, lz * rx - lx * rz, lx * ry - ly * rx], axis=-1)


def rotate(quaternion: Floats, vector: Floats) -> Floats:
    """(..., 3) vectors rotated by unit quaternions (..., 4)."""
    axis = quaternion[..., :3]
    turned = 2.0 * cross(axis, vector)
    return vector + quaternion[..., 3:] * turned + cross(axis, turned)


def transform(target_from_source: Floats, points_in_source: Floats) -> Floats:
    """(..., 3) points by Sim(3) rows (..., 8)."""
    turned = rotate(normalized(target_from_source[..., 3:7]), points_in_source)
    return target_from_source[..., 7:] * turned + target_from_source[..., :3]


def transform_back(target_from_source: Floats, points_in_target: Floats) -> Floats:
    """(..., 3) points by the inverses of Sim(3) rows (..., 8)."""
    inverse = conjugate(normalized(target_from_source[..., 3:7]))
    return rotate(inverse, points_in_target - target_from_source[..., :3]) / target_from_source[..., 7:]


def inverse_pose(target_from_source: Floats) -> Floats:
    """(..., 7) source_from_target."""
    rotation = conjugate(normalized(target_from_source[..., 3:7]))
    return np.concatenate([rotate(rotation, -target_from_source[..., :3]), rotation], axis=-1)


def compose_pose(target_from_middle: Floats, middle_from_source: Floats) -> Floats:
    """(..., 7) target_from_source; `target_from_middle` may be a Sim(3) (..., 8): its scale acts on the translation."""
    rotation = normalized(target_from_middle[..., 3:7])
    offset = rotate(rotation, middle_from_source[..., :3])
    if target_from_middle.shape[-1] == 8:
        offset = target_from_middle[..., 7:] * offset
    turned = normalized(multiply(rotation, normalized(middle_from_source[..., 3:7])))
    return np.concatenate([target_from_middle[..., :3] + offset, turned], axis=-1)


def rotation_matrices(quaternion: Floats) -> Floats:
    """(N, 3, 3) of quaternions (N, 4)."""
    unit = normalized(quaternion)
    columns = [rotate(unit, np.broadcast_to(axis, (len(unit), 3))) for axis in np.eye(3)]
    return np.stack(columns, axis=-1)
