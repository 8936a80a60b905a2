# SPDX-License-Identifier: Apache-2.0
"""Instances and their truth out of COCO's JSON or of two folders of label images."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.categories import NO_CATEGORY, category_id
from services.evaluation.progress import Progress, silent
from services.formats.coco import (
    CocoAnnotation,
    CocoCategory,
    CocoDataset,
    CocoImage,
    CocoResult,
    read_coco,
    read_coco_results,
)
from services.formats.json_file import read_json
from services.formats.label_images import LabelledInstance, read_label_image, read_label_index
from services.formats.rle import encode_mask, mask_area
from services.runtime.errors import InputError

_FIRST_OWN_ID = 1000
"""Ids of categories that are none of COCO's 80 begin here."""


@dataclass(frozen=True)
class MaskInput:
    """True and found instances of the same images.

    `without_result` names the frames of a folder that the other has no word about: nothing was found there.
    `without_truth` is how many frames the found folder has beyond the truth's; they do not count.
    """

    truth: CocoDataset
    found: tuple[CocoResult, ...]
    without_result: tuple[str, ...] = ()
    without_truth: int = 0

    def category_ids(self, names: Sequence[str] = ()) -> list[int]:
        """The ids of the categories named; without names, of those that have a true instance.

        Raises:
            InputError: a name of which the truth has no instance; says those it has.
        """
        present = {annotation.category_id for annotation in self.truth.annotations}
        by_name = {c.name: c.category_id for c in self.truth.categories if c.category_id in present}
        for name in names:
            if name not in by_name:
                known = ", ".join(by_name) or "those of a truth that is not empty"
                raise InputError(f"category {name!r}: not in the truth, expected one of {known}")
        return sorted({by_name[name] for name in names} if names else present)


def read_mask_input(found: Path, truth: Path, progress: Progress = silent) -> MaskInput:
    """Read two JSON files (COCO's annotations, and results or annotations) or two folders of label images.

    Raises:
        InputError: one of each, no frame in common, images of other sizes, a true mask without a pixel, or what the
            formats refuse.
    """
    for path in (found, truth):
        if not path.exists():
            raise InputError(f"{path}: no such file or folder, expected COCO's JSON or a folder of label images")
    if truth.is_dir() != found.is_dir():
        kinds = {True: "a folder", False: "a file"}
        raise InputError(
            f"{found} is {kinds[found.is_dir()]}, {truth} {kinds[truth.is_dir()]}: expected two of a kind, "
            "COCO's JSON or folders of label images"
        )
    given = _from_folders(found, truth, progress) if truth.is_dir() else _from_json(found, truth)
    for annotation in given.truth.annotations:
        if mask_area(annotation.mask) == 0:
            name = next(i.file_name for i in given.truth.images if i.image_id == annotation.image_id)
            raise InputError(
                f"{truth}: instance {annotation.annotation_id} of {name} has an empty mask, expected a pixel"
            )
    return given


def _from_json(found: Path, truth: Path) -> MaskInput:
    dataset = read_coco(truth)
    if isinstance(read_json(found, "COCO's results or annotations"), list):
        results = read_coco_results(found, dataset)
    else:
        results = _as_results(found, read_coco(found), dataset)
    return MaskInput(dataset, results)


def _as_results(path: Path, found: CocoDataset, truth: CocoDataset) -> tuple[CocoResult, ...]:
    """Annotations as results, all sure; their images are the truth's by file name, their categories by name."""
    images = {image.file_name: image for image in truth.images}
    if len(images) < len(truth.images) or "" in images:
        raise InputError(f"{path}: the truth's images have no file names of their own, expected COCO's results instead")
    categories = {category.name: category.category_id for category in truth.categories}
    image_of, category_of = {}, {category.category_id: categories.get(category.name) for category in found.categories}
    for image in found.images:
        true = images.get(image.file_name)
        if true is not None and (true.width, true.height) != (image.width, image.height):
            size = f"{image.width}x{image.height} px, expected {true.width}x{true.height} as in the truth"
            raise InputError(f"{path}: {image.file_name} is of {size}")
        image_of[image.image_id] = true
    if found.images and not any(image_of.values()):
        raise InputError(f"{path}: no image of the truth's, expected file names such as {next(iter(images), 'none')}")
    rows = ((a, image_of[a.image_id], category_of[a.category_id]) for a in found.annotations)
    return tuple(
        CocoResult(image.image_id, category, annotation.mask, 1.0)
        for annotation, image, category in rows
        if image is not None and category is not None
    )


def _from_folders(found: Path, truth: Path, progress: Progress) -> MaskInput:
    true_index, found_index = read_label_index(truth), read_label_index(found)
    if not true_index:
        raise InputError(f"{truth}: no frames, expected label images with their instances")
    frames = sorted(true_index)
    if not set(frames) & set(found_index):
        raise InputError(
            f"{found}: no frame of the truth's, expected names such as {frames[0]!r}; "
            f"found {next(iter(sorted(found_index)), 'none')!r}"
        )
    ids = _category_ids(
        {item.category for index in (true_index, found_index) for rows in index.values() for item in rows}
    )
    images, annotations, results = [], [], []
    for number, frame in enumerate(progress(frames, "reading masks"), start=1):
        labels = read_label_image(truth / f"{frame}.png")
        image = CocoImage(number, frame, labels.shape[1], labels.shape[0])
        images.append(image)
        for item in true_index[frame]:
            mask = encode_mask(labels == item.label)
            annotations.append(CocoAnnotation.of_mask(item.label, number, ids[item.category], mask))
        if frame in found_index:
            results += _results(found / f"{frame}.png", image, found_index[frame], ids)
    categories = tuple(CocoCategory(number, name) for name, number in sorted(ids.items(), key=lambda row: row[1]))
    return MaskInput(
        CocoDataset(tuple(images), categories, tuple(annotations)),
        tuple(results),
        tuple(frame for frame in frames if frame not in found_index),
        len(set(found_index) - set(frames)),
    )


def _results(
    path: Path, image: CocoImage, items: Sequence[LabelledInstance], ids: Mapping[str, int]
) -> list[CocoResult]:
    labels: npt.NDArray[np.uint16] = read_label_image(path)
    if labels.shape != (image.height, image.width):
        raise InputError(
            f"{path}: {labels.shape[1]}x{labels.shape[0]} px, expected {image.width}x{image.height} as in the truth"
        )
    return [CocoResult(image.image_id, ids[i.category], encode_mask(labels == i.label), i.score) for i in items]


def _category_ids(names: Collection[str]) -> dict[str, int]:
    own = sorted(name for name in names if category_id(name) == NO_CATEGORY)
    return {name: category_id(name) for name in names if category_id(name) != NO_CATEGORY} | {
        name: _FIRST_OWN_ID + place for place, name in enumerate(own)
    }
