# SPDX-License-Identifier: Apache-2.0
"""Dense optical flow from the current image back to the previous one, and where it is to be trusted."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from services.motion.flow.algorithm import Pixels
from services.motion.flow.configured_algorithm import configured_algorithm
from services.motion.flow.dis import Dis
from services.motion.flow.options import OpticalFlowOptions
from services.runtime.errors import InputError


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
        """Raise InputError, ResourceError as configured_algorithm."""
        self._options = options or OpticalFlowOptions()
        self._algorithm = configured_algorithm(self._options)
        # the way back only serves as a check: DIS without its costly variational refinement will do for any flow
        self._check = Dis("ultrafast", self._options.finest_level)

    def kept(self, pixels: Pixels) -> Pixels:
        """What of an image, grey or BGR, is needed when the next one comes."""
        return pixels if self._algorithm.takes_colour else grey_of(pixels)

    def previous_from_current(self, current: Pixels, previous: Pixels) -> FlowField:
        """The flow between two images. Raise InputError when they differ in size."""
        if current.shape[:2] != previous.shape[:2]:
            raise InputError(f"images of {previous.shape[:2]} and {current.shape[:2]}: expected two of the same size")
        height, width = current.shape[:2]
        shrink = 2 ** max(0, int(np.ceil(np.log2(width / self._options.largest_width_px))))
        size = (width // shrink, height // shrink)
        now, before = self.kept(current), self.kept(previous)
        if shrink > 1:
            now, before = _resized(now, size), _resized(before, size)
        flow = self._algorithm.flow(now, before)
        back = self._check.flow(grey_of(before), grey_of(now))
        columns, rows = np.meshgrid(np.arange(size[0], dtype=np.float32), np.arange(size[1], dtype=np.float32))
        returned = flow + cv2.remap(back, columns + flow[..., 0], rows + flow[..., 1], cv2.INTER_LINEAR)
        miss = np.hypot(returned[..., 0], returned[..., 1]).astype(np.float32)
        if shrink > 1:
            scale = np.array([width / size[0], height / size[1]], np.float32)
            flow = np.asarray(cv2.resize(flow, (width, height)) * scale, np.float32)
            miss = np.asarray(cv2.resize(miss, (width, height)) * np.float32(shrink), np.float32)
        return FlowField(grey_of(current), grey_of(previous), flow, miss)


def grey_of(pixels: Pixels) -> npt.NDArray[np.uint8]:
    """(H, W) of an image, grey or BGR."""
    return pixels if pixels.ndim == 2 else np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY), np.uint8)


def _resized(image: npt.NDArray[np.uint8], size: tuple[int, int]) -> npt.NDArray[np.uint8]:
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
