# SPDX-License-Identifier: Apache-2.0
"""MOTS: masks of objects whose ids last, as text (`frame id class_id height width rle`) or as 16-bit PNG images.

Source: Voigtlaender et al., "MOTS: Multi-Object Tracking and Segmentation", CVPR 2019, and KITTI MOTS' annotations.
An id is `class * 1000 + n`; the classes are car 1, person 2 and, for regions in which nothing found is wrong, 10.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from services.formats.png import described, read_png, write_png
from services.formats.rle import Rle, checked_rle, decode_mask, encode_mask, masks_overlap
from services.formats.text_rows import TextRow, read_rows
from services.runtime.errors import InputError

CAR = 1
PERSON = 2
IGNORED = 10
"""Class of a region in which nothing found is wrong; its id is 10000."""
CLASS_NAMES = {CAR: "car", PERSON: "pedestrian", IGNORED: "ignore"}
IDS_PER_CLASS = 1000

_EXPECTED = "MOTS text: frame id class_id height width rle"
_LARGEST_SIDE_PX = 65535


@dataclass(frozen=True)
class MotsObject:
    """One object in one frame. `frame` counts from 0, `object_id` is `class_id * 1000 + n` and lasts."""

    frame: int
    object_id: int
    class_id: int
    mask: Rle


def mots_id(class_id: int, number: int) -> int:
    """The id of the `number`th object of a class. Raises InputError for a number that has no room below the next."""
    if not 0 <= number < IDS_PER_CLASS:
        raise InputError(f"object {number} of class {class_id}: expected 0..{IDS_PER_CLASS - 1}, MOTS has no more ids")
    return class_id * IDS_PER_CLASS + number


def read_mots_text(path: Path) -> tuple[MotsObject, ...]:
    """Read a sequence, ordered by frame and id; a file without lines is a sequence without objects.

    Raises:
        InputError: no such file, a line that is not as above, an id twice in a frame or masks that overlap in one.
    """
    objects = sorted((_parse(row) for row in read_rows(path, _EXPECTED)), key=lambda item: (item.frame, item.object_id))
    for frame, found in groupby(objects, key=lambda item: item.frame):
        _check_frame(f"{path} frame {frame}", list(found))
    return tuple(objects)


def write_mots_text(path: Path, objects: Iterable[MotsObject]) -> None:
    """Write a sequence, ordered by frame and id. Raises InputError where two masks of a frame overlap."""
    ordered = sorted(objects, key=lambda item: (item.frame, item.object_id))
    for frame, found in groupby(ordered, key=lambda item: item.frame):
        _check_frame(f"{path} frame {frame}", list(found))
    lines = [
        f"{item.frame} {item.object_id} {item.class_id} {item.mask.height} {item.mask.width} {item.mask.counts}\n"
        for item in ordered
    ]
    path.write_text("".join(lines), encoding="ascii")


def read_mots_png(path: Path, frame: int) -> tuple[MotsObject, ...]:
    """Read one frame: pixel = id, 0 = background, 10000 = ignored. Raises InputError for what is no such image."""
    pixels = read_png(path, "a MOTS label image: one channel of 16 bits")
    if pixels.ndim != 2 or pixels.dtype not in (np.uint8, np.uint16):
        raise InputError(f"{path}: {described(pixels)}, expected one channel of 16 bits")
    ids = [int(value) for value in np.unique(pixels) if value != 0]
    if ids and ids[0] < IDS_PER_CLASS:
        raise InputError(f"{path}: id {ids[0]}, expected class * {IDS_PER_CLASS} + n")
    return tuple(MotsObject(frame, number, number // IDS_PER_CLASS, encode_mask(pixels == number)) for number in ids)


def write_mots_png(path: Path, objects: Sequence[MotsObject], height: int, width: int) -> None:
    """Write one frame's objects as an image of `height` x `width` px. Raises InputError for masks of another size."""
    pixels = np.zeros((height, width), dtype=np.uint16)
    for item in objects:
        if (item.mask.height, item.mask.width) != (height, width):
            found = f"{item.mask.width}x{item.mask.height}"
            raise InputError(f"{path}: object {item.object_id} has a mask of {found} px, expected {width}x{height}")
        pixels[decode_mask(item.mask)] = item.object_id
    write_png(path, pixels)


def _parse(row: TextRow) -> MotsObject:
    if len(row.fields) != 6:
        raise InputError(f"{row.path}:{row.line}: {len(row.fields)} fields, expected 6 as in {_EXPECTED}")
    frame = row.whole(0, "frame", 0)
    object_id, class_id = row.whole(1, "id", 0), row.whole(2, "class_id", 0)
    height, width = row.whole(3, "height", 1), row.whole(4, "width", 1)
    if max(height, width) > _LARGEST_SIDE_PX:
        raise row.error("size", f"{width}x{height}", f"at most {_LARGEST_SIDE_PX} px a side")
    try:
        mask = checked_rle(height, width, row.fields[5])
    except InputError as error:
        raise InputError(f"{row.path}:{row.line}: {error}") from None
    return MotsObject(frame, object_id, class_id, mask)


def _check_frame(place: str, objects: list[MotsObject]) -> None:
    ids = [item.object_id for item in objects if item.class_id != IGNORED]
    if len(set(ids)) != len(ids):
        twice = next(number for number in ids if ids.count(number) > 1)
        raise InputError(f"{place}: id {twice} stands there twice, expected each once")
    sizes = {(item.mask.width, item.mask.height) for item in objects}
    if len(sizes) > 1:
        raise InputError(f"{place}: masks of {sorted(sizes)} px, expected one size a frame")
    if masks_overlap([item.mask for item in objects]):
        raise InputError(f"{place}: masks overlap, expected each pixel to belong to one object")
