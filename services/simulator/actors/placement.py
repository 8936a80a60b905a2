# SPDX-License-Identifier: Apache-2.0
"""Where upright things stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def planar_pose(xy: Floats, heading: float) -> Floats:
    """world_from_object, 4x4, of an upright object on the plane z = 0."""
    cos, sin = np.cos(heading), np.sin(heading)
    matrix = np.eye(4)
    matrix[:2, :2] = [[cos, -sin], [sin, cos]]
    matrix[:2, 3] = xy
    return matrix
