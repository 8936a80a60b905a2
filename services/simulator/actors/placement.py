# SPDX-License-Identifier: Apache-2.0
"""Where things stand, and how a camera sits on what carries it. Bases: x forward, y left, z up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

BASE_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""3x3; optical frames look along z, x to the right, y down."""


def rotation_about(axis: int, angle_rad: float) -> Floats:
    """Rotation matrix, 3x3, about x (0), y (1) or z (2), by the right hand."""
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.eye(3)
    rotation[i, i] = rotation[j, j] = cos
    rotation[i, j], rotation[j, i] = -sin, sin
    return rotation


def planar_pose(xy: Floats, heading: float) -> Floats:
    """world_from_object, 4x4, of an upright object on the plane z = 0."""
    cos, sin = np.cos(heading), np.sin(heading)
    matrix = np.eye(4)
    matrix[:2, :2] = [[cos, -sin], [sin, cos]]
    matrix[:2, 3] = xy
    return matrix


def axle_pose(rear: Floats, front: Floats) -> Floats:
    """world_from_object, 4x4, of an object whose two axles stand on these points (3,), its origin midway; no roll."""
    ahead = (front - rear) / np.linalg.norm(front - rear)
    left = np.array([-ahead[1], ahead[0], 0.0]) / np.hypot(ahead[0], ahead[1])
    up = np.array([-ahead[2] * left[1], ahead[2] * left[0], ahead[0] * left[1] - ahead[1] * left[0]])
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = ahead, left, up
    matrix[:3, 3] = 0.5 * (rear + front)
    return matrix
