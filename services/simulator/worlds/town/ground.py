# SPDX-License-Identifier: Apache-2.0
"""The shape of the ground: smooth hills with streets, kerbs and pavements on top."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.carriageways import DistanceMap
from services.simulator.worlds.town.profile import KERB_HEIGHT_M

Floats = NDArray[np.float64]

SHORTEST_WAVE_M = 170.0
_LONGEST_WAVE_M = 420.0
_WAVES = 7
_ACROSS = 1.3
"""How much steeper than along the streets the ground may be across them."""
_KERB_STEP_M = 0.3
FLAT_BEYOND_M = 260.0
"""Hills end this far outside the town."""


class Hills:
    """Sum of plane waves over the world plane, zero at the origin, levelled out far outside the town.

    A function of the place alone, so that a street that returns to a place returns to its height.
    """

    def __init__(self, rng: np.random.Generator, centre: Floats, radius_m: float) -> None:
        length = rng.uniform(SHORTEST_WAVE_M, _LONGEST_WAVE_M, _WAVES)
        direction = rng.uniform(0.0, 2.0 * np.pi, _WAVES)
        self._wave = (2.0 * np.pi / length) * np.stack([np.cos(direction), np.sin(direction)])
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _WAVES)
        # Equal slope for every wave: longer ones are higher.
        self._height_m = length / length.mean()
        self._centre, self._radius_m = centre, radius_m

    def scaled_to(self, points: Floats, ahead: Floats, max_slope: float) -> None:
        """Make `max_slope` the steepest along directions `ahead` (N, 2) at `points` (N, 2)."""
        gradient = self._gradient(points)
        along = np.abs(np.einsum("ni,ni->n", gradient, ahead)).max()
        anyhow = np.linalg.norm(gradient, axis=1).max() / _ACROSS
        self._height_m = self._height_m * (0.98 * max_slope / max(float(along), float(anyhow)))

    def _gradient(self, points: Floats) -> Floats:
        phase = points @ self._wave + self._phase
        return np.asarray((np.cos(phase) * self._height_m) @ self._wave.T)

    def height_m(self, xy: Floats) -> Floats:
        """Height at (..., 2), shape (...)."""
        waves = np.sin(xy @ self._wave + self._phase) - np.sin(self._phase)
        outside = np.hypot(xy[..., 0] - self._centre[0], xy[..., 1] - self._centre[1]) - self._radius_m
        u = np.minimum(np.maximum(outside / FLAT_BEYOND_M, 0.0), 1.0)
        return np.asarray((waves @ self._height_m) * (1.0 - u * u * (3.0 - 2.0 * u)))


@dataclass(frozen=True, slots=True)
class TownGround:
    """Hills, and on them carriageways that lie a kerb lower than everything else."""

    hills: Hills
    distances: DistanceMap

    def height_m(self, xy: Floats) -> Floats:
        """Height of the ground at world positions (..., 2), shape (...); kerbs are climbed over 0.3 m."""
        xy = np.asarray(xy, np.float64)
        up = np.minimum(np.maximum(self.distances.outside_m(xy) / _KERB_STEP_M + 0.5, 0.0), 1.0)
        return np.asarray(self.hills.height_m(xy) + KERB_HEIGHT_M * up)


def sampling_m(max_slope: float, error_m: float = 0.002) -> float:
    """Step at which a mesh follows the hills to `error_m`, which is an eighth of their bend times the step squared."""
    bend = max(max_slope, 1e-3) * _ACROSS * 2.0 * np.pi / SHORTEST_WAVE_M
    return float(np.clip(np.sqrt(8.0 * error_m / bend), 1.5, 4.0))
