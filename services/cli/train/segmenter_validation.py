# SPDX-License-Identifier: Apache-2.0
"""How good a network is that is being trained: mask AP on data it does not learn from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from services.cli.train.training_data import TrainingData
from services.formats.coco import CocoDataset, CocoResult, read_coco
from services.formats.rle import encode_mask

if TYPE_CHECKING:
    from services.segmenter.solov2.network import SoloV2
    from services.segmenter.solov2.variants import Variant
    from services.segmenter.training.trainer import Trainer


class Validation:
    """Reads the data once; raises InputError for what is not as COCO says."""

    def __init__(self, data: Sequence[TrainingData], categories: tuple[str, ...], variant: Variant) -> None:
        self._sets = [(item, read_coco(item.annotations)) for item in data]
        self._categories = categories
        self._box = variant.test_size

    def judge(self, trainer: Trainer) -> dict[str, float]:
        """Mean AP and AP50 over all categories and sets, by the curve's name; nothing where there is no data."""
        if not self._sets:
            return {}
        network = trainer.averaged_network()
        scores = [self._score(network, item, truth) for item, truth in self._sets]
        return {
            "mask AP": sum(ap for ap, _ in scores) / len(scores),
            "mask AP50": sum(ap50 for _, ap50 in scores) / len(scores),
        }

    def _score(self, network: SoloV2, item: TrainingData, truth: CocoDataset) -> tuple[float, float]:
        from services.evaluation.instance_masks.average_precision import mask_precision

        ids = [category.category_id for category in truth.categories if category.name in self._categories]
        present = {annotation.category_id for annotation in truth.annotations}
        mean = mask_precision(truth, self._found(network, item, truth), [i for i in ids if i in present]).mean
        return mean.ap or 0.0, mean.ap50 or 0.0

    def _found(self, network: SoloV2, item: TrainingData, truth: CocoDataset) -> list[CocoResult]:
        import cv2
        import numpy as np

        from services.segmenter.inference import TorchInference

        inference = TorchInference(network, self._box)
        id_by_name = {category.name: category.category_id for category in truth.categories}
        ids = [id_by_name.get(name) for name in self._categories]
        found = []
        for image in truth.images:
            pixels = cv2.imread(str(item.images / image.file_name))
            instances = inference.segment(np.asarray(pixels, np.uint8))
            masks, labels = instances.masks.cpu().numpy(), instances.labels.tolist()
            for mask, label, score in zip(masks, labels, instances.scores.tolist(), strict=True):
                number = ids[label]
                if number is not None:
                    found.append(CocoResult(image.image_id, number, encode_mask(mask), score))
        return found
