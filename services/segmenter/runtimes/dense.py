# SPDX-License-Identifier: Apache-2.0
"""What each way to run a network looks like."""

from typing import Protocol

import numpy as np
import numpy.typing as npt

from services.segmenter.solov2.head import HeadOutput


class Dense(Protocol):
    """Computes what is dense in a network."""

    def __call__(self, pixels: npt.NDArray[np.float32]) -> HeadOutput:
        """(1, 3, H, W) as preprocessing.py makes it, to what the head says, in 32 bits. Valid until the next call."""
