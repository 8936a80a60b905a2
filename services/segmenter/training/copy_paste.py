# SPDX-License-Identifier: Apache-2.0
"""Copy-paste (Ghiasi et al., CVPR 2021): instances of another image, in another size, in front of this one."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from services.segmenter.training.geometric_augmentation import Mirror, placed, resized
from services.segmenter.training.sample import Sample


@dataclass(frozen=True)
class CopyPaste:
    """Pastes some instances of another sample; what they cover of older instances is no longer theirs."""

    share: float = 0.8
    """of the samples that get something pasted"""
    most_instances: int = 8
    scales: tuple[float, float] = (0.5, 1.6)
    least_visible: float = 0.2
    """of an older instance's pixels; one of which less is left is left out"""

    def paste(self, sample: Sample, draw: Callable[[], Sample], random: np.random.Generator) -> Sample:
        """`sample` with instances of one that is drawn where it is needed; the images may differ in size."""
        if random.random() >= self.share:
            return sample
        other = draw()
        if len(other.labels) == 0:
            return sample
        other = self._moved(Mirror()(other, random), sample.image.shape[:2], random)
        chosen = random.permutation(len(other.labels))[: int(random.integers(1, self.most_instances + 1))]
        chosen = chosen[other.masks[chosen].any((1, 2))]
        if len(chosen) == 0:
            return sample
        pasted = other.masks[chosen]
        cover = np.asarray(pasted.any(0))
        # a soft rim, or the network learns to see the seam
        alpha = np.asarray(cv2.GaussianBlur(np.asarray(cover, np.float32), (0, 0), 0.7))[..., None]
        image = (sample.image * (1 - alpha) + other.image * alpha + 0.5).astype(np.uint8)
        left = sample.masks * ~cover
        areas, areas_left = (masks.sum((1, 2), dtype=np.int64) for masks in (sample.masks, left))
        kept = areas_left >= np.maximum(1, self.least_visible * areas)
        masks = np.concatenate([left[kept], pasted])
        return Sample(image, masks, np.concatenate([sample.labels[kept], other.labels[chosen]]))

    def _moved(self, sample: Sample, shape: tuple[int, ...], random: np.random.Generator) -> Sample:
        """The sample scaled and shifted by chance, in the other's size."""
        height, width = shape
        factor = np.exp(random.uniform(*np.log(self.scales))) * height / sample.image.shape[0]
        scaled = resized(
            sample, max(1, round(sample.image.shape[1] * factor)), max(1, round(sample.image.shape[0] * factor))
        )
        shift_x = int(random.integers(-width // 4, width // 4 + 1)) + (width - scaled.image.shape[1]) // 2
        shift_y = int(random.integers(-height // 8, height // 8 + 1)) + (height - scaled.image.shape[0]) // 2
        return placed(scaled, (width, height), shift_x, shift_y)
