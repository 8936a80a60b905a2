# SPDX-License-Identifier: Apache-2.0
"""How much really moves around a position, counted from the true objects by the rule that the map counts by."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from schemas.records import TrueInstances

_NS_PER_S = 1_000_000_000


@dataclass(frozen=True)
class TrueDensityRules:
    """Which true objects count: those that the truth calls moving, at least this high in the image. What is smaller
    nobody could have seen."""

    minimum_height_px: float = 40.0


class TrueDensity:
    """Where every truly moving object was seen, and when."""

    def __init__(self, rules: TrueDensityRules | None = None) -> None:
        self.rules = rules or TrueDensityRules()
        self._sightings: dict[int, list[tuple[int, tuple[float, float, float]]]] = {}

    def add(self, truth: TrueInstances) -> None:
        """Take the objects of one frame; frames come in the order of time."""
        for row in truth.objects:
            if row.moving and row.box_px[3] >= self.rules.minimum_height_px:
                self._sightings.setdefault(row.instance_id, []).append((truth.timestamp_ns, row.position_m))

    def at(self, timestamp_ns: int, position: npt.NDArray[np.float64], radius_m: float, window_s: float) -> int:
        """Objects that move around `position` (3,), world frame, at a time.

        With a window, an object counts where it was last seen moving inside the window that ends then (both ends
        included), once; without one (infinity), wherever it was ever seen moving up to then. An object's place is the
        middle of its cuboid.
        """
        begin_ns = -math.inf if math.isinf(window_s) else timestamp_ns - round(window_s * _NS_PER_S)
        count = 0
        for sightings in self._sightings.values():
            seen = [place for time_ns, place in sightings if begin_ns <= time_ns <= timestamp_ns]
            places = np.array(seen if math.isinf(window_s) else seen[-1:]).reshape(-1, 3)
            count += bool((np.linalg.norm(places - position, axis=1) <= radius_m).any())
        return count
