# SPDX-License-Identifier: Apache-2.0
"""Grey levels and the light they stand for (IEC 61966-2-1, sRGB)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats32 = NDArray[np.float32]

_STEPS = 8191


def _encoded(light: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1.0 / 2.4) - 0.055)


def _decoded(grey: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(grey <= 0.04045, grey / 12.92, ((grey + 0.055) / 1.055) ** 2.4)


_LIGHT_OF_GREY = _decoded(np.arange(256) / 255.0).astype(np.float32)
_GREY_OF_ROOT = np.rint(255.0 * _encoded(np.square(np.arange(_STEPS + 1) / _STEPS))).astype(np.uint8)
"""By the root of the light, so that the dark end is as fine as the bright one."""

MEDIUM_GREY = 128
MEDIUM_LIGHT = float(_LIGHT_OF_GREY[MEDIUM_GREY])
GREY_PER_LIGHT = float(2.0 / (_LIGHT_OF_GREY[MEDIUM_GREY + 1] - _LIGHT_OF_GREY[MEDIUM_GREY - 1]))
"""Grey levels a unit of light, at medium grey."""


def light_of(image: NDArray[np.uint8]) -> Floats32:
    """Light, 0 to 1, of grey levels."""
    return np.asarray(_LIGHT_OF_GREY[image])


def image_of(light: Floats32) -> NDArray[np.uint8]:
    """Grey levels of light, cut off at 0 and 1."""
    root = np.sqrt(np.clip(light, 0.0, 1.0))
    return np.asarray(_GREY_OF_ROOT[(root * np.float32(_STEPS) + np.float32(0.5)).astype(np.intp)])
