# SPDX-License-Identifier: Apache-2.0
"""Whether two ways to run a network find the same."""

from pathlib import Path
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from services.runtime.errors import ResourceError
from services.segmenter.solov2.instances import SegmentedInstances

LEAST_KEPT: Final = 0.1
"""what both sides keep, so that an instance on the edge of being sure is there on both"""
_SURE: Final = 0.3
_LEAST_COUNT: Final = 3
"""instances that are compared although they are not sure, where there are as many"""
_SAMPLE: Final = Path(__file__).parent / "sample.jpg"


def sample_images() -> list[npt.NDArray[np.uint8]]:
    """A picture of the simulator's with something in it, and what it looks like mirrored, darker and nearer.

    (H, W, 3) BGR, all of one size. Raises ResourceError where it is missing.
    """
    image = cv2.imread(str(_SAMPLE))
    if image is None:
        raise ResourceError(f"{_SAMPLE}: no readable image, expected the one that comes with this package")
    height, width = image.shape[:2]
    nearer = cv2.resize(image[height // 4 :, : width * 3 // 4], (width, height))
    return [np.asarray(view, np.uint8) for view in (image, image[:, ::-1], image // 2, nearer)]


def overlaps(exact: SegmentedInstances, other: SegmentedInstances) -> list[float]:
    """The largest IoU with one of its category, of each instance that the exact side is sure of, or of its surest."""
    sure = exact.scores >= _SURE
    sure[:_LEAST_COUNT] = True
    if len(other.scores) == 0:
        return [0.0] * int(sure.sum())
    one, two = exact.masks[sure].flatten(1).float(), other.masks.flatten(1).float()
    shared = one @ two.T
    iou = shared / (one.sum(1)[:, None] + two.sum(1)[None] - shared).clamp(min=1)
    iou = iou * (exact.labels[sure][:, None] == other.labels[None])
    return [float(value) for value in iou.amax(1)]
