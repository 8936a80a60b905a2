# SPDX-License-Identifier: Apache-2.0
"""Pixels that say nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


class PixelRain:
    """Black and white pixels, `share` of all, others in each frame (salt and pepper)."""

    def __init__(self, share: float) -> None:
        self._share = share

    def fall(self, image: NDArray[np.uint8], rng: np.random.Generator) -> None:
        """Change an image (H, W, 3) in place."""
        draw = rng.random(image.shape[:2], np.float32)
        image[draw < 0.5 * self._share] = 0
        image[draw > 1.0 - 0.5 * self._share] = 255
