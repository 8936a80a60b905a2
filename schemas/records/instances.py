# SPDX-License-Identifier: Apache-2.0
"""What the segmenter gives: which pixels are one potentially dynamic object."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Instance:
    """One object of one image; its id means nothing in the next."""

    instance_id: int
    category: str
    score: float
    box_px: tuple[float, float, float, float]
    """x, y, width, height"""


@dataclass(frozen=True)
class Instances:
    """`labels` is uint32 (H, W), 0 = background, else an instance's id. `skipped`: this frame was not segmented."""

    timestamp_ns: int
    labels: npt.NDArray[np.uint32]
    instances: tuple[Instance, ...]
    skipped: bool = False
