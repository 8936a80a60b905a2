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
        cv2.resize(np.ascontiguousarray(mask), (width, height), dst=target, interpolation=cv2.INTER_NEAREST_EXACT)
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
class RandomScale:
    """Scales the image about as it fits, changes its aspect, cuts off what is too much; black beyond the border.

    Nearly all of the image stays: the network knows by its coordinates where in the image something is, and what was
    learned on small sections of images does not hold on whole ones.
    """

    size: tuple[int, int]
    """(width, height) of what comes out"""
    scales: tuple[float, float] = (0.8, 1.5)
    """of the scale at which the image just fits"""
    aspect: float = 0.15
    """how far width and height may differ in scale"""
    around_instance: float = 0.7
    """share of the cuts that show a certain instance, if there is one"""
    least_px: int = 16
    """instances of fewer pixels are left out: nothing can be learned of them"""

    def __call__(self, sample: Sample, random: np.random.Generator) -> Sample:
        height, width = sample.image.shape[:2]
        factor = min(self.size[0] / width, self.size[1] / height) * np.exp(random.uniform(*np.log(self.scales)))
        stretch = np.exp(random.uniform(-self.aspect, self.aspect) / 2)
        factors = (factor * stretch, factor / stretch)
        shown = [min(of, round(new / by)) for of, new, by in zip((width, height), self.size, factors, strict=True)]
        x, y = self._corner(sample, (shown[0], shown[1]), random)
        part = np.s_[y : y + shown[1], x : x + shown[0]]
        masks = sample.masks[:, *part]
        seen = masks.any((1, 2))
        section = Sample(np.ascontiguousarray(sample.image[part]), masks[seen], sample.labels[seen])
        scaled = [min(new, max(1, round(of * by))) for of, new, by in zip(shown, self.size, factors, strict=True)]
        return placed(resized(section, scaled[0], scaled[1]), self.size, 0, 0).with_visible_instances(self.least_px)

    def _corner(self, sample: Sample, shown: tuple[int, int], random: np.random.Generator) -> tuple[int, int]:
        """Upper left corner of the section (width, height) in the image."""
        room = np.array(sample.image.shape[1::-1]) - shown
        corner = random.random(2) * room
        if len(sample.masks) and random.random() < self.around_instance:
            x, y, box_width, box_height = cv2.boundingRect(sample.masks[int(random.integers(len(sample.masks)))])
            center = np.array((x + box_width / 2, y + box_height / 2))
            corner = np.clip(center - random.uniform(0.2, 0.8, 2) * shown, 0, room)
        return round(corner[0]), round(corner[1])
