# SPDX-License-Identifier: Apache-2.0
"""One image to learn from."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Sample:
    """An image and its instances."""

    image: npt.NDArray[np.uint8]
    """(H, W, 3) BGR"""
    masks: npt.NDArray[np.uint8]
    """(M, H, W), 1 on the instance"""
    labels: npt.NDArray[np.int64]
    """(M,) positions among the categories that are learned"""

    def with_visible_instances(self, least_px: int = 1) -> "Sample":
        """Without those of which fewer than `least_px` pixels are left."""
        kept = self.masks.sum((1, 2), dtype=np.int64) >= least_px
        return Sample(self.image, self.masks[kept], self.labels[kept])


class Samples(Protocol):
    """Where samples come from; the same number gives the same sample."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> Sample:
        """Raises InputError when what the sample is made of cannot be read."""

    def aspect(self, index: int, /) -> float:
        """Width by height of the sample's image, without reading it."""
