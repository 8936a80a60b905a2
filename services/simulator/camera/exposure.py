# SPDX-License-Identifier: Apache-2.0
"""An exposure that is never quite right."""

from __future__ import annotations

import numpy as np

_TAG = 103
_HZ = np.array([0.11, 0.23, 0.41])
_WEIGHTS = np.array([0.5, 0.3, 0.2])


class ExposureWobble:
    """Swings smoothly by up to `stops` to both sides."""

    def __init__(self, stops: float, seed: int) -> None:
        rng = np.random.default_rng([seed, _TAG])
        self._stops = stops
        self._phase = rng.uniform(0.0, 2.0 * np.pi, len(_HZ))
        self._hz = _HZ * rng.uniform(0.8, 1.25, len(_HZ))

    def gain(self, t_s: float) -> float:
        """Factor of the light at a time."""
        swing = float(_WEIGHTS @ np.sin(2.0 * np.pi * self._hz * t_s + self._phase))
        return float(2.0 ** (self._stops * swing))
