# SPDX-License-Identifier: Apache-2.0
"""The plan of a town: what its houses and its traffic both follow.

World frame: x forward and y left at the start of the loop's right inner lane, z up, metres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Line(Protocol):
    """A centre line with coordinates: s along it, n to its left, metres."""

    @property
    def length_m(self) -> float:
        """How far s goes."""
        ...

    def point(self, s: Floats | float, n: Floats | float) -> Floats:
        """World (x, y), shape (..., 2)."""
        ...

    def heading(self, s: Floats | float) -> Floats:
        """Angle of the centre line against world x, radians, counter-clockwise, without jumps."""
        ...


class Ground(Protocol):
    """The ground, kerbs included."""

    def height_m(self, xy: Floats) -> Floats:
        """Height of the ground at world positions (..., 2), shape (...); kerbs are climbed over 0.3 m."""
        ...


@dataclass(frozen=True, slots=True)
class Crossing:
    """A junction of the loop at `s_m`: the side streets that lead away from it.

    left, right: with s = 0 on the loop's centre line, s growing outwards; None where there is none.
    """

    s_m: float
    left: Line | None
    right: Line | None


@dataclass(frozen=True, slots=True)
class TownPlan:
    """loop: closed, periodic in s. crossings: by s. zebras_m: where people cross the loop."""

    loop: Line
    crossings: Sequence[Crossing]
    zebras_m: Sequence[float]
    ground: Ground

    def near_crossing(self, s_m: float, margin_m: float) -> bool:
        """Whether a junction lies within `margin_m` of s along the loop."""
        around = self.loop.length_m
        return any(
            abs((s_m - crossing.s_m + 0.5 * around) % around - 0.5 * around) < margin_m for crossing in self.crossings
        )
