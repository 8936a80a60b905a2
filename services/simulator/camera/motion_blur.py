# SPDX-License-Identifier: Apache-2.0
"""What an open shutter makes of motion."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

Floats32 = NDArray[np.float32]

_FEWEST, _MOST = 3, 25
_STEP_PX = 1.0


class MotionBlur:
    """Spreads each pixel along its own motion; `share` of the time between two frames that the shutter is open.

    The exposure's middle is the frame's time, so that truth stays in the middle of the blur.
    """

    def __init__(self, share: float) -> None:
        self._share = share

    def spread(self, light: Floats32, flow_px: Floats32) -> Floats32:
        """Linear light (H, W, 3) averaged along flow (H, W, 2), pixels from this frame to the next."""
        trail = flow_px * np.float32(self._share)
        longest = float(np.percentile(np.abs(trail).max(axis=-1), 99.0))
        taps = int(np.clip(2 * np.ceil(0.5 * longest / _STEP_PX) + 1, _FEWEST, _MOST))
        rows, columns = np.mgrid[0 : light.shape[0], 0 : light.shape[1]].astype(np.float32)
        total = np.zeros_like(light)
        for when in (np.arange(taps) + 0.5) / taps - 0.5:
            x, y = columns + trail[..., 0] * np.float32(when), rows + trail[..., 1] * np.float32(when)
            total += cv2.remap(light, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(total / np.float32(taps))
