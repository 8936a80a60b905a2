# SPDX-License-Identifier: Apache-2.0
"""How good a network is: mask AP on data it does not learn from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from services.cli.train.training_data import TrainingData
from services.formats.coco import CocoAnnotation, CocoDataset, CocoImage, CocoResult, read_coco
from services.formats.rle import encode_mask
from services.runtime.errors import InputError

if TYPE_CHECKING:
    from services.evaluation.instance_masks.average_precision import MaskPrecision
    from services.segmenter.solov2.network import SoloV2

KITTI_HEIGHT_PX = 25.0
"""Of the least boxes that count in KITTI's object benchmark (moderate and hard). Simulated truth has objects of single
pixels, half of all: with those even perfect masks, in the resolution of the network's, reach an AP of 0.4 only."""


class Validation:
    """All the data as one set, read once.

    Args:
        data: where it lies.
        categories: names, in the order of the network's outputs; others do not count.
        box: (width, height) that images are fitted into.
        least_height_px: true instances less high are neither missed nor wrong where they are found.

    Raises:
        InputError: what is not as COCO says, or two files that number the categories differently.
    """

    def __init__(
        self,
        data: Sequence[TrainingData],
        categories: tuple[str, ...],
        box: tuple[int, int],
        least_height_px: float = KITTI_HEIGHT_PX,
    ) -> None:
        truth, self._paths = _joined(data)
        self._truth = replace(truth, annotations=tuple(_counted(row, least_height_px) for row in truth.annotations))
        self._box = box
        number_of = {category.name: category.category_id for category in self._truth.categories}
        self._numbers = [number_of.get(name) for name in categories]
        present = {annotation.category_id for annotation in self._truth.annotations if not annotation.is_crowd}
        self._asked = [number for number in self._numbers if number in present]

    def judge(self, network: SoloV2) -> dict[str, float]:
        """Mean AP and AP50, and those of each category, by the curve's name; nothing where there is no data."""
        if not self._asked:
            return {}
        score = self.precision(network)
        sides = {"mask": score.mean, **score.by_category}
        named = {f"{name} AP": side.ap for name, side in sides.items()}
        named |= {f"{name} AP50": side.ap50 for name, side in sides.items()}
        return {name: value or 0.0 for name, value in named.items()}

    def precision(self, network: SoloV2) -> MaskPrecision:
        """Average precision of the categories that the data have. Raises InputError where they have none."""
        from services.evaluation.instance_masks.average_precision import mask_precision

        return mask_precision(self._truth, self._found(network), [i for i in self._asked if i is not None])

    def _found(self, network: SoloV2) -> list[CocoResult]:
        import cv2
        import numpy as np

        from services.segmenter.inference import SoloInference
        from services.segmenter.runtimes.torch_dense import TorchDense

        inference = SoloInference(TorchDense(network), network.variant, self._box)
        found = []
        for image in self._truth.images:
            pixels = cv2.imread(str(self._paths[image.image_id]))
            if pixels is None:
                raise InputError(f"{self._paths[image.image_id]}: no readable image, expected one to judge by")
            instances = inference.segment(np.asarray(pixels, np.uint8))
            masks, labels = instances.masks.cpu().numpy(), instances.labels.tolist()
            for mask, label, score in zip(masks, labels, instances.scores.tolist(), strict=True):
                number = self._numbers[label]
                if number is not None:
                    found.append(CocoResult(image.image_id, number, encode_mask(mask), score))
        return found


def _counted(annotation: CocoAnnotation, least_height_px: float) -> CocoAnnotation:
    """As a crowd where it is not high enough: whatever is found there does not count."""
    return replace(annotation, is_crowd=annotation.is_crowd or annotation.box_px[3] < least_height_px)


def _joined(data: Sequence[TrainingData]) -> tuple[CocoDataset, dict[int, Path]]:
    """One data set of all, its images numbered anew, and where each lies."""
    images: list[CocoImage] = []
    annotations = []
    paths = {}
    categories = None
    for item in data:
        read = read_coco(item.annotations)
        if categories is not None and read.categories != categories:
            raise InputError(f"{item.annotations}: other categories than {data[0].annotations}, expected the same")
        categories = read.categories
        number_of = {image.image_id: len(images) + place for place, image in enumerate(read.images, start=1)}
        for image in read.images:
            images.append(replace(image, image_id=number_of[image.image_id]))
            paths[images[-1].image_id] = item.images / image.file_name
        annotations += [replace(row, image_id=number_of[row.image_id]) for row in read.annotations]
    return CocoDataset(tuple(images), categories or (), tuple(annotations)), paths
