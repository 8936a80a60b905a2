# SPDX-License-Identifier: Apache-2.0
"""Samples made of coloured boxes: blue ones are category 0, red ones 1."""

import numpy as np

from services.segmenter.training.sample import Sample

BLUE, RED = (220, 40, 40), (30, 60, 230)


def painted_sample(seed: int, size: tuple[int, int] = (160, 96), boxes: int = 3) -> Sample:
    """(width, height) of `size`, noise in the background, later boxes in front of earlier ones."""
    width, height = size
    random = np.random.default_rng(seed)
    image = (random.random((height, width, 3)) * 60 + 60).astype(np.uint8)
    masks = np.zeros((boxes, height, width), np.uint8)
    labels = random.integers(0, 2, boxes)
    for number in range(boxes):
        w, h = int(random.integers(width // 8, width // 3)), int(random.integers(height // 6, height // 2))
        x, y = int(random.integers(0, width - w)), int(random.integers(0, height - h))
        masks[:number, y : y + h, x : x + w] = 0
        masks[number, y : y + h, x : x + w] = 1
        image[y : y + h, x : x + w] = (BLUE, RED)[labels[number]]
    return Sample(image, masks, labels.astype(np.int64)).with_visible_instances()


class PaintedSamples:
    """So many of them."""

    def __init__(self, count: int = 16) -> None:
        self._count = count

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: int, /) -> Sample:
        return painted_sample(index)

    def aspect(self, index: int, /) -> float:
        return 160 / 96
