# SPDX-License-Identifier: Apache-2.0
"""Which two axes of a world frame lie on the ground, told by how the camera looked into it."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

_AXIS_NAMES = ("x", "y", "z")


class GroundPlane(NamedTuple):
    """Two axes of a frame, right-handed as seen from above: `axes` their columns, `names` what to write beside them."""

    axes: tuple[int, int]
    names: tuple[str, str]

    def project(self, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """(N, 3) to (N, 2)."""
        return points[:, self.axes]


FLAT = GroundPlane((0, 1), ("x", "y"))
"""of a frame with z up (REP-103)"""


def ground_plane(world_from_camera: npt.NDArray[np.float64]) -> GroundPlane:
    """The plane across the axis nearest to where the cameras' optical y (down) points; poses (N, 4, 4), N > 0."""
    down = world_from_camera[:, :3, 1].mean(axis=0)
    vertical = int(np.argmax(np.abs(down)))
    first, second = (vertical + 1) % 3, (vertical + 2) % 3
    axes = (second, first) if down[vertical] > 0.0 else (first, second)
    return GroundPlane(axes, (_AXIS_NAMES[axes[0]], _AXIS_NAMES[axes[1]]))
