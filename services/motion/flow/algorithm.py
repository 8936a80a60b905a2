# SPDX-License-Identifier: Apache-2.0
"""What every way of computing dense flow is to the motion service."""

from typing import Protocol

import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[np.uint8]
"""(H, W) grey or (H, W, 3) BGR"""


class FlowAlgorithm(Protocol):
    """Computes where each pixel of one image is in another one; the same images give the same bytes."""

    takes_colour: bool
    """whether it is given images in colour, where they have any"""

    def flow(self, start: Pixels, end: Pixels) -> npt.NDArray[np.float32]:
        """(H, W, 2) px: pixel x of `start` is at x + flow[x] in `end`. Both images have the same size."""
