# SPDX-License-Identifier: Apache-2.0
"""How much moves around a pose."""

from dataclasses import dataclass
from enum import IntEnum


class DensityLevel(IntEnum):
    """Never observed, or fewer, or at least the threshold of moving points."""

    UNKNOWN = 0
    LOW = 1
    HIGH = 2


@dataclass(frozen=True)
class Density:
    """The answer to one density query. Lengths are in metres, or in map units where `metric_scale` is false."""

    timestamp_ns: int
    position: tuple[float, float, float]
    radius: float
    window_s: float
    """infinity: ever"""
    moving_points: int
    moving_objects: int
    observed_points: int
    level: DensityLevel
    metric_scale: bool
