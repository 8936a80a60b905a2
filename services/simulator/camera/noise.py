# SPDX-License-Identifier: Apache-2.0
"""Noise of a sensor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.linear_light import GREY_PER_LIGHT, MEDIUM_LIGHT

Floats32 = NDArray[np.float32]

_READ_SHARE = 0.02
"""Of the variance at medium grey, what is there without light; the rest is shot noise and grows with the light."""


class SensorNoise:
    """Photons counted one by one and electronics that read them (Janesick, Photon Transfer, 2007): normal, its variance
    linear in the light.

    grey_levels: standard deviation at medium grey.
    """

    def __init__(self, grey_levels: float) -> None:
        self._variance = (grey_levels / GREY_PER_LIGHT) ** 2

    def added(self, light: Floats32, rng: np.random.Generator) -> Floats32:
        """Linear light of any shape with noise from a generator of its frame."""
        shot = np.float32(self._variance * (1.0 - _READ_SHARE) / MEDIUM_LIGHT)
        read = np.float32(self._variance * _READ_SHARE)
        noise = rng.standard_normal(light.shape, np.float32)
        noise *= np.sqrt(np.maximum(light, np.float32(0.0)) * shot + read)
        return np.asarray(light + noise)
