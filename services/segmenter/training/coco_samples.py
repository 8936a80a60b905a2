# SPDX-License-Identifier: Apache-2.0
"""Samples out of COCO's JSON and the images it names."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from services.formats.coco import CocoAnnotation, CocoImage, read_coco
from services.formats.rle import decode_mask
from services.runtime.errors import InputError
from services.segmenter.training.sample import Sample


class CocoSamples:
    """The images of one file of annotations; instances of other categories, and crowds, are background.

    Args:
        annotations: COCO's JSON.
        images: the folder that its file names are relative to.
        categories: names, in the order of the network's outputs.

    Raises:
        InputError: the file is not as COCO says, has no image, or none of the categories.
    """

    def __init__(self, annotations: Path, images: Path, categories: Sequence[str]) -> None:
        dataset = read_coco(annotations)
        position = {name: index for index, name in enumerate(categories)}
        self._label_of = {c.category_id: position[c.name] for c in dataset.categories if c.name in position}
        if not dataset.images or not self._label_of:
            raise InputError(
                f"{annotations}: {len(dataset.images)} images, {len(self._label_of)} of the categories "
                f"{', '.join(categories)}; expected at least one of each"
            )
        self._folder = images
        self._images: tuple[CocoImage, ...] = dataset.images
        self._instances: dict[int, list[CocoAnnotation]] = {image.image_id: [] for image in dataset.images}
        for annotation in dataset.annotations:
            if annotation.category_id in self._label_of and not annotation.is_crowd:
                self._instances[annotation.image_id].append(annotation)

    def __len__(self) -> int:
        return len(self._images)

    def __getitem__(self, index: int, /) -> Sample:
        image = self._images[index]
        path = self._folder / image.file_name
        try:
            pixels = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_COLOR)
        except (OSError, cv2.error) as error:
            raise InputError(f"{path}: cannot be read ({error})") from error
        if pixels is None or pixels.shape[:2] != (image.height, image.width):
            found = "no image" if pixels is None else f"{pixels.shape[1]}x{pixels.shape[0]} px"
            raise InputError(f"{path}: {found}, expected an image of {image.width}x{image.height} px")
        instances = self._instances[image.image_id]
        masks = np.zeros((len(instances), image.height, image.width), np.uint8)
        for mask, instance in zip(masks, instances, strict=True):
            mask[...] = decode_mask(instance.mask)
        labels = np.array([self._label_of[instance.category_id] for instance in instances], np.int64)
        return Sample(np.asarray(pixels, np.uint8), masks, labels)

    def aspect(self, index: int, /) -> float:
        """Width by height, as the annotations say."""
        return self._images[index].width / self._images[index].height


class JoinedSamples:
    """Several sources, one after the other."""

    def __init__(self, parts: Sequence[CocoSamples]) -> None:
        self._parts = parts
        self._ends = np.cumsum([len(part) for part in parts])

    def __len__(self) -> int:
        return int(self._ends[-1])

    def __getitem__(self, index: int, /) -> Sample:
        part, own_index = self._place(index)
        return part[own_index]

    def aspect(self, index: int, /) -> float:
        """Width by height."""
        part, own_index = self._place(index)
        return part.aspect(own_index)

    def _place(self, index: int) -> tuple[CocoSamples, int]:
        part = int(np.searchsorted(self._ends, index, side="right"))
        return self._parts[part], index - (int(self._ends[part - 1]) if part else 0)
