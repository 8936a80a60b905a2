# SPDX-License-Identifier: Apache-2.0
"""Dense inverse search (Kroeger et al., ECCV 2016), OpenCV's."""

from types import MappingProxyType
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from services.motion.flow.algorithm import Pixels
from services.runtime.errors import InputError

PRESETS: Final = MappingProxyType(
    {
        "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
        "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
        "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    }
)


class Dis:
    """DIS with one of OpenCV's presets.

    Raises:
        InputError: an unknown preset.
    """

    takes_colour = False

    def __init__(self, preset: str, finest_level: int) -> None:
        if preset not in PRESETS:
            raise InputError(f"optical flow preset {preset!r}: expected one of {', '.join(PRESETS)}")
        self._algorithm = cv2.DISOpticalFlow.create(PRESETS[preset])
        self._algorithm.setFinestScale(finest_level)

    def flow(self, start: Pixels, end: Pixels) -> npt.NDArray[np.float32]:
        flow = self._algorithm.calc(start, end, None)  # type: ignore[call-overload]  # the stubs lack "no first guess"
        return np.asarray(flow, np.float32)
