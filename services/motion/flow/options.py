# SPDX-License-Identifier: Apache-2.0
"""Which flow, and how fine."""

from dataclasses import dataclass
from typing import Literal

AlgorithmName = Literal["dis", "raft"]


@dataclass(frozen=True)
class OpticalFlowOptions:
    """Images wider than `largest_width_px` are halved first; `finest_level` is that of DIS' pyramid (0: all pixels).

    Measured on KITTI 03 (1242 px, one thread; median and 90 % distance from the true epipolar line): whole size,
    level 1 36 ms, 0.35 and 1.11 px; halved, level 1 10 ms, 0.39 and 1.29 px; whole size, level 2 11 ms, 0.39 and 1.30.
    """

    preset: str = "fast"
    largest_width_px: int = 800
    finest_level: int = 1
    algorithm: AlgorithmName = "dis"
    weights: str | None = None
    """raft: a file or a name of `kinemap weights`"""
    iterations: int = 12
    """of raft"""
    device: str = "cpu"
    """of raft, as torch names devices, or auto"""
    threads: int = 1
