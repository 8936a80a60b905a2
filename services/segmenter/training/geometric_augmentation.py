# SPDX-License-Identifier: Apache-2.0
"""What moves an image's content: mirroring, and another size and section."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from services.segmenter.training.sample import Sample


def resized(sample: Sample, width: int, height: int) -> Sample:
    """The sample in another size; masks stay 0 and 1."""
    image = cv2.resize(sample.image, (width, height), interpolation=cv2.INTER_LINEAR)
    masks = np.zeros((len(sample.masks), height, width), np.uint8)
    for target, mask in zip(masks, sample.masks, strict=True):
        cv2.resize(mask, (width, height), dst=target, interpolation=cv2.INTER_NEAREST_EXACT)
    return Sample(np.asarray(image, np.uint8), masks, sample.labels)


def placed(sample: Sample, size: tuple[int, int], x: int, y: int) -> Sample:
    """The sample with its upper left corner at (x, y) of an image of `size` (width, height); black where it is not."""
    width, height = size
    to_x, to_y, from_x, from_y = max(0, x), max(0, y), max(0, -x), max(0, -y)
    columns = max(0, min(width - to_x, sample.image.shape[1] - from_x))
    rows = max(0, min(height - to_y, sample.image.shape[0] - from_y))
    here = np.s_[to_y : to_y + rows, to_x : to_x + columns]
    there = np.s_[from_y : from_y + rows, from_x : from_x + columns]
    image = np.zeros((height, width, 3), np.uint8)
    masks = np.zeros((len(sample.masks), height, width), np.uint8)
    image[here] = sample.image[there]
    masks[:, *here] = sample.masks[:, *there]
    return Sample(image, masks, sample.labels)


@dataclass(frozen=True)
class Mirror:
    """Left and right change places in half of the samples."""

    def __call__(self, sample: Sample, random: np.random.Generator) -> Sample:
        if random.random() < 0.5:
            return sample
        return Sample(_turned(sample.image), _turned_masks(sample.masks), sample.labels)


def _turned(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    return np.ascontiguousarray(image[:, ::-1])


def _turned_masks(masks: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    return np.ascontiguousarray(masks[:, :, ::-1])


@dataclass(frozen=True)
class RandomSection:
    """Scales the image about what fits `size`, its aspect too, and takes a section of it; black beyond the border."""

    size: tuple[int, int]
    """(width, height) of what comes out"""
    scales: tuple[float, float] = (0.6, 1.8)
    """of the size that just fills `size`"""
    aspect: float = 0.1
    """how far width and height may differ in scale"""
    least_px: int = 16
    """instances of fewer pixels are left out: nothing can be learned of them"""

    def __call__(self, sample: Sample, random: np.random.Generator) -> Sample:
        height, width = sample.image.shape[:2]
        # most often not far from the size that is used later, now and then much larger or smaller
        factor = max(self.size[0] / width, self.size[1] / height) * np.exp(random.uniform(*np.log(self.scales)))
        stretch = np.exp(random.uniform(-self.aspect, self.aspect) / 2)
        new_width, new_height = max(1, round(width * factor * stretch)), max(1, round(height * factor / stretch))
        scaled = resized(sample, new_width, new_height)
        x = round(random.random() * max(0, new_width - self.size[0]))
        y = round(random.random() * max(0, new_height - self.size[1]))
        return placed(scaled, self.size, -x, -y).with_visible_instances(self.least_px)
