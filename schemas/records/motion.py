# SPDX-License-Identifier: Apache-2.0
"""What the motion service gives: the camera's own motion, and what moves besides."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class EgoMotion:
    """The camera's motion between two frames, from the flow of the background (essential matrix)."""

    timestamp_ns: int
    previous_timestamp_ns: int
    valid: bool
    reason: str
    rotation: npt.NDArray[np.float64]
    """(3, 3) current_from_previous, camera optical frame"""
    translation_direction: npt.NDArray[np.float64]
    """(3,) unit length; zero where there is no baseline"""
    inlier_ratio: float
    samples: int
    background_flow_px: float
    parallax_px: float


@dataclass(frozen=True)
class InstanceMotion:
    """One instance with the probability that it moves and the evidence for it."""

    instance_id: int
    category: str
    score: float
    box_px: tuple[float, float, float, float]
    moving_probability: float
    """0..1; 0.5 where there is no evidence"""
    epipolar_residual_px: float
    residual_noise_px: float
    samples: int
    age_frames: int
    """0: measured in this frame; n: carried here by the flow for n frames"""


@dataclass(frozen=True)
class InstanceMotions:
    """The instances, measured or carried; `labels` is uint32 (H, W), 0 = background."""

    timestamp_ns: int
    labels: npt.NDArray[np.uint32]
    instances: tuple[InstanceMotion, ...]


@dataclass(frozen=True)
class MovingMask:
    """uint8 (H, W): 255 where a pixel moves by itself, 0 elsewhere."""

    timestamp_ns: int
    mask: npt.NDArray[np.uint8]
