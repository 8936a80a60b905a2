# SPDX-License-Identifier: Apache-2.0
"""What the camera gives: images, calibration, and truth where there is some."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

DistortionModel = Literal["plumb_bob", "kannala_brandt"]


@dataclass(frozen=True)
class Image:
    """One image. `pixels` is uint8, (H, W) grey or (H, W, 3) blue-green-red."""

    timestamp_ns: int
    pixels: npt.NDArray[np.uint8]
    frame_id: str = "camera"


@dataclass(frozen=True)
class DepthImage:
    """Depth along the optical axis in metres, float32 (H, W); 0 where there is none."""

    timestamp_ns: int
    depth_m: npt.NDArray[np.float32]
    frame_id: str = "camera"


@dataclass(frozen=True)
class CameraCalibration:
    """A camera: pinhole, or with the distortion of a lens."""

    timestamp_ns: int
    width: int
    height: int
    intrinsics: npt.NDArray[np.float64]
    """(3, 3), px"""
    distortion: tuple[float, ...] = ()
    """plumb_bob: k1, k2, p1, p2, k3; kannala_brandt: k1, k2, k3, k4; as OpenCV has them; empty for a rectified image"""
    projection: npt.NDArray[np.float64] | None = None
    """(3, 4) of the rectified pair; for the right camera, [0, 3] is -fx * baseline_m"""
    frame_id: str = "camera"
    distortion_model: DistortionModel = "plumb_bob"


@dataclass(frozen=True)
class TruePose:
    """Ground truth: where the camera really is."""

    timestamp_ns: int
    world_from_camera: npt.NDArray[np.float64]
    """(4, 4), metres; the camera frame is optical (x right, y down, z forward)"""


@dataclass(frozen=True)
class TrueObject:
    """The simulator's truth about one object in one image."""

    instance_id: int
    category: str
    moving: bool
    velocity_m_s: tuple[float, float, float]
    position_m: tuple[float, float, float]
    box_px: tuple[float, float, float, float]
    heading_rad: float = 0.0
    size_m: tuple[float, float, float] | None = None
    """length, width, height of the cuboid round `position_m`; None where it is not known"""


@dataclass(frozen=True)
class TrueInstances:
    """The simulator's label image (uint32, (H, W), 0 = background) and its objects."""

    timestamp_ns: int
    labels: npt.NDArray[np.uint32]
    objects: tuple[TrueObject, ...]


@dataclass(frozen=True)
class FrameManifest:
    """What the camera sends under one timestamp; sent first, so that others know what to wait for."""

    timestamp_ns: int
    source: str
    frame_name: str
    topics: tuple[str, ...]
    frame_count: int = -1
    rate_hz: float = 10.0


@dataclass(frozen=True)
class EndOfInput:
    """The input is over after `frame_count` frames."""

    timestamp_ns: int
    frame_count: int
