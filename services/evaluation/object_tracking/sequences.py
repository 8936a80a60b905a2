# SPDX-License-Identifier: Apache-2.0
"""One sequence of tracked objects out of MOTS text or images, KITTI's labels, or a folder of label images."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from services.evaluation.object_tracking.matching import Box, ObjectSequence, SeenObject
from services.formats.kitti_tracking import DONT_CARE, NO_ID, read_kitti_tracking
from services.formats.label_images import INDEX_NAME, LabelledInstance, read_label_image, read_label_index
from services.formats.mots import CLASS_NAMES, IGNORED, MotsObject, read_mots_png, read_mots_text
from services.formats.rle import Rle, encode_mask
from services.formats.text_rows import read_rows
from services.runtime.errors import InputError

EXPECTED = "MOTS text (6 fields a line), KITTI tracking labels (17 or 18), or a folder of label images"
_LARGEST_OCCLUDED = 2
_LARGEST_TRUNCATED = 0
# KITTI tracking writes "Person" for one who sits; COCO's persons are pedestrians.
_KITTI_NAMES = {"person": "person_sitting"}
_COCO_NAMES = {"person": "pedestrian"}


def holds_images(folder: Path) -> bool:
    """Whether a folder is a sequence of label images."""
    return (folder / INDEX_NAME).is_file() or next(folder.glob("*.png"), None) is not None


def read_text_sequence(name: str, path: Path) -> ObjectSequence:
    """A text file, its format told by the fields of its first line. Raises InputError as the formats do."""
    row = next(read_rows(path, EXPECTED), None)
    match None if row is None else len(row.fields):
        case None:
            return ObjectSequence(name, {})
        case 6:
            return _from_mots(name, read_mots_text(path))
        case 17 | 18:
            return _from_kitti(name, path)
        case count:
            raise InputError(f"{path}:1: {count} fields, expected {EXPECTED}")


def frame_names(folder: Path) -> list[str]:
    """The frames of a folder of label images, in order."""
    if (folder / INDEX_NAME).is_file():
        return sorted(read_label_index(folder))
    return sorted(path.stem for path in folder.glob("*.png"))


def read_image_sequence(name: str, folder: Path, numbers: Mapping[str, int]) -> ObjectSequence:
    """A folder of label images with `instances.json`, or of MOTS images without; `numbers` are its frames' by name.

    Frames that have no number are left out. Raises InputError as the formats do.
    """
    if not (folder / INDEX_NAME).is_file():
        frames = [frame for frame in frame_names(folder) if frame in numbers]
        objects = (item for frame in frames for item in read_mots_png(folder / f"{frame}.png", numbers[frame]))
        return _from_mots(name, objects)
    index = read_label_index(folder)
    seen = {numbers[f]: _labelled(folder / f"{f}.png", rows) for f, rows in index.items() if rows and f in numbers}
    return ObjectSequence(name, seen)


def _labelled(path: Path, rows: Iterable[LabelledInstance]) -> tuple[SeenObject, ...]:
    labels = read_label_image(path)
    shown = set(np.unique(labels).tolist())
    return tuple(
        SeenObject(row.label, _COCO_NAMES.get(row.category, row.category), encode_mask(labels == row.label))
        for row in rows
        if row.label in shown
    )


def _from_mots(name: str, objects: Iterable[MotsObject]) -> ObjectSequence:
    seen, ignored = defaultdict[int, list[SeenObject]](list), defaultdict[int, list[Rle | Box]](list)
    for item in objects:
        if item.class_id == IGNORED:
            ignored[item.frame].append(item.mask)
        else:
            category = CLASS_NAMES.get(item.class_id, f"class {item.class_id}")
            seen[item.frame].append(SeenObject(item.object_id, category, item.mask))
    return ObjectSequence(name, seen, ignored)


def _from_kitti(name: str, path: Path) -> ObjectSequence:
    boxes = read_kitti_tracking(path)
    if boxes and all(box.object_id == NO_ID for box in boxes):
        raise InputError(f"{path}: every id is {NO_ID}, expected ids that last from frame to frame")
    seen, ignored = defaultdict[int, list[SeenObject]](list), defaultdict[int, list[Rle | Box]](list)
    for box in boxes:
        if box.category == DONT_CARE:
            ignored[box.frame].append(box.box_px)
        elif box.object_id != NO_ID:
            category = _KITTI_NAMES.get(box.category.lower(), box.category.lower())
            hard = box.occluded > _LARGEST_OCCLUDED or box.truncated > _LARGEST_TRUNCATED
            seen[box.frame].append(SeenObject(box.object_id, category, box.box_px, hard))
    return ObjectSequence(name, seen, ignored)
