# SPDX-License-Identifier: Apache-2.0
"""All sequences' instances in one file, as COCO has it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from schemas.categories import CATEGORY_IDS, CATEGORY_NAMES, NO_CATEGORY, category_id
from services.formats.coco import CocoAnnotation, CocoCategory, CocoDataset, CocoImage
from services.simulator.data_sets.frame_truth import FrameTruth
from services.simulator.data_sets.layout import SequencePaths
from services.simulator.options import DriveOptions


def coco_dataset(options: DriveOptions, sequences: Mapping[str, Sequence[FrameTruth]]) -> CocoDataset:
    """Annotations of the left colour images, ids counted through from 1, none of them a crowd.

    The categories are all of COCO's; what is none of them is left out. `attributes` say `track_id`, which lasts over a
    sequence, and `moving`. File names are relative to the data set.
    """
    categories = tuple(CocoCategory(number, name) for number, name in zip(CATEGORY_IDS, CATEGORY_NAMES, strict=True))
    images: list[CocoImage] = []
    annotations: list[CocoAnnotation] = []
    for sequence, frames in sequences.items():
        paths = SequencePaths(sequence)
        for frame in frames:
            image_id = len(images) + 1
            images.append(CocoImage(image_id, paths.image(2, frame.index), options.width, options.height))
            for item in frame.objects:
                attributes = {"track_id": item.object_id, "moving": item.moving}
                number = category_id(item.category)
                if number == NO_CATEGORY:
                    continue
                annotations.append(
                    CocoAnnotation.of_mask(len(annotations) + 1, image_id, number, item.mask, attributes)
                )
    return CocoDataset(tuple(images), categories, tuple(annotations), {"description": "kinemap simulate"})
