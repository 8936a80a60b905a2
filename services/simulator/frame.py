# SPDX-License-Identifier: Apache-2.0
"""What a simulated camera gives for one time, with everything that is true of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class SimulatedInstance:
    """One visible vehicle or person.

    instance_id: its pixels' value in the labels, the same over the whole drive. category: name in COCO.
    moving: speed of at least 0.1 m/s at this frame. velocity_m_s, position_m: world frame, (3,); the position is the
    middle of the cuboid. heading_rad: against world x. size_m: length, width, height of the cuboid.
    box_px: x, y, width, height round the visible pixels. visible_px: how many there are. pitch_rad: of the cuboid's
    x axis above the plane, upwards positive.
    """

    instance_id: int
    category: str
    moving: bool
    velocity_m_s: NDArray[np.float64]
    position_m: NDArray[np.float64]
    heading_rad: float
    size_m: tuple[float, float, float]
    box_px: tuple[int, int, int, int]
    visible_px: int
    pitch_rad: float = 0.0


@dataclass(frozen=True, slots=True)
class SimulatedFrame:
    """One frame of a drive.

    image: BGR uint8 (H, W, 3); image_right: the same of the second camera, where there is one. Everything else is true
    of the first camera at this time, also where the image is not (black, or the one of the frame before).
    depth_m: float32 (H, W) along the optical axis, 0 = sky. labels: uint16 (H, W), 0 = nobody, else an instance_id.
    world_from_camera: 4x4; world x forward and y left at the start, z up; camera optical.
    """

    index: int
    timestamp_ns: int
    image: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    labels: NDArray[np.uint16]
    instances: list[SimulatedInstance]
    world_from_camera: NDArray[np.float64]
    image_right: NDArray[np.uint8] | None = None


@dataclass(frozen=True, slots=True)
class SimulatedFlow:
    """Motion of every pixel from a frame to the next one.

    flow_px: float32 (H, W, 2), columns and rows. visible: bool (H, W), whether the surface is still seen there; false
    where it leaves the image or is hidden. Sky moves as a thing at infinite distance.
    """

    flow_px: NDArray[np.float32]
    visible: NDArray[np.bool_]
