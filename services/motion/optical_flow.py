# SPDX-License-Identifier: Apache-2.0
"""Dense optical flow from the current image back to the previous one (Kroeger et al., ECCV 2016: DIS)."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError

PRESETS = {
    "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
    "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
    "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
}


@dataclass(frozen=True)
class OpticalFlowOptions:
    """Images wider than `largest_width_px` are halved first; `finest_level` is that of DIS' pyramid (0: all pixels).

    Measured on KITTI 03 (1242 px, one thread; median and 90 % distance from the true epipolar line): whole size,
    level 1 36 ms, 0.35 and 1.11 px; halved, level 1 10 ms, 0.39 and 1.29 px; whole size, level 2 11 ms, 0.39 and 1.30.
    """

    preset: str = "fast"
    largest_width_px: int = 800
    finest_level: int = 1


@dataclass(frozen=True)
class FlowField:
    """Pixel x of `current` was at x + `flow`[x] in `previous`; grey uint8 (H, W) images, float32 (H, W, 2) flow in px.

    `miss`, float32 (H, W) px, is how far from x the flow of `previous` to `current` ends that starts there: large where
    one of the two is wrong (hidden there, no texture).
    """

    current: npt.NDArray[np.uint8]
    previous: npt.NDArray[np.uint8]
    flow: npt.NDArray[np.float32]
    miss: npt.NDArray[np.float32]


class DenseFlow:
    """Where each pixel of the current image was in the previous one.

    Backwards, because masks, samples and answers all belong to the current image: they look their pixel up directly.
    """

    def __init__(self, options: OpticalFlowOptions | None = None) -> None:
        """Raise InputError for an unknown preset."""
        self._options = options or OpticalFlowOptions()
        if self._options.preset not in PRESETS:
            raise InputError(f"optical flow preset {self._options.preset!r}: expected one of {', '.join(PRESETS)}")
        self._algorithm = cv2.DISOpticalFlow.create(PRESETS[self._options.preset])
        self._algorithm.setFinestScale(self._options.finest_level)
        # the way back only serves as a check: its costly variational refinement is left out
        self._check = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST)
        self._check.setFinestScale(self._options.finest_level)

    def previous_from_current(self, current: npt.NDArray[np.uint8], previous: npt.NDArray[np.uint8]) -> FlowField:
        """The flow between two grey images (H, W). Raise InputError when they differ in size."""
        if current.shape != previous.shape:
            raise InputError(f"images of {previous.shape} and {current.shape}: expected two of the same size")
        height, width = current.shape
        shrink = 2 ** max(0, int(np.ceil(np.log2(width / self._options.largest_width_px))))
        size = (width // shrink, height // shrink)
        now, before = current, previous
        if shrink > 1:
            now, before = _resized(current, size), _resized(previous, size)
        flow = _calculate(self._algorithm, now, before)
        back = _calculate(self._check, before, now)
        columns, rows = np.meshgrid(np.arange(size[0], dtype=np.float32), np.arange(size[1], dtype=np.float32))
        returned = flow + cv2.remap(back, columns + flow[..., 0], rows + flow[..., 1], cv2.INTER_LINEAR)
        miss = np.hypot(returned[..., 0], returned[..., 1]).astype(np.float32)
        if shrink > 1:
            scale = np.array([width / size[0], height / size[1]], np.float32)
            flow = np.asarray(cv2.resize(flow, (width, height)) * scale, np.float32)
            miss = np.asarray(cv2.resize(miss, (width, height)) * np.float32(shrink), np.float32)
        return FlowField(current, previous, flow, miss)


def _resized(image: npt.NDArray[np.uint8], size: tuple[int, int]) -> npt.NDArray[np.uint8]:
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def _calculate(
    algorithm: cv2.DISOpticalFlow, start: npt.NDArray[np.uint8], end: npt.NDArray[np.uint8]
) -> npt.NDArray[np.float32]:
    flow = algorithm.calc(start, end, None)  # type: ignore[call-overload]  # the stubs do not know "no first guess"
    return np.asarray(flow, np.float32)
