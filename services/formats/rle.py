# SPDX-License-Identifier: Apache-2.0
"""COCO's run-length encoded masks, by pycocotools: columns first, the counts of 0 and 1 in turn, compressed to text."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError, ResourceError

_FARTHEST_PX = 1e6
"""pycocotools counts in 32 bits: a polygon's point farther away would be drawn elsewhere."""


@dataclass(frozen=True)
class Rle:
    """A mask of `height` x `width` pixels; `counts` is COCO's compressed text."""

    height: int
    width: int
    counts: str

    def as_coco(self) -> dict[str, Any]:
        """As it stands in COCO's JSON."""
        return {"size": [self.height, self.width], "counts": self.counts}


def checked_rle(height: int, width: int, counts: str) -> Rle:
    """A mask out of a file. pycocotools reads beyond its memory where the counts do not fit: they are checked here.

    Raises:
        InputError: counts that are no compressed RLE or do not add up to height x width.
    """
    pixels = height * width
    runs = _runs(counts)
    if runs is None:
        raise InputError("a mask that is no compressed RLE, expected COCO's RLE text")
    if (total := int(runs.sum())) != pixels:
        raise InputError(f"a mask of {total} pixels, expected {width}x{height} = {pixels}")
    return Rle(height, width, counts)


def rle_from_coco(segmentation: Any, height: int, width: int) -> Rle:
    """A mask out of COCO's JSON: compressed or plain RLE, or polygons, which are drawn as pycocotools does.

    Raises:
        InputError: none of the three, or of another size than `height` x `width`.
    """
    match segmentation:
        case {"size": [int(rle_height), int(rle_width)], "counts": str() | list() as counts}:
            if (rle_height, rle_width) != (height, width):
                raise InputError(f"a mask of {rle_width}x{rle_height} px, expected {width}x{height} as its image")
            if isinstance(counts, str):
                return checked_rle(height, width, counts)
            if not all(type(count) is int and count >= 0 for count in counts) or sum(counts) != height * width:
                raise InputError(f"a mask whose counts do not add up, expected {width}x{height} = {height * width}")
            return _from_coco(_mask_api().frPyObjects({"size": [height, width], "counts": counts}, height, width))
        case [list(), *_] as polygons if all(_is_polygon(polygon) for polygon in polygons):
            api = _mask_api()
            return _from_coco(api.merge(api.frPyObjects(polygons, height, width)))
    raise InputError(f"no mask, expected RLE (size, counts) or polygons of 3 points and more, to {_FARTHEST_PX:g} px")


def encode_mask(mask: npt.NDArray[Any]) -> Rle:
    """A mask (H, W): whatever is not 0 belongs to it."""
    return _from_coco(_mask_api().encode(np.asfortranarray(mask != 0, dtype=np.uint8)))


def decode_mask(rle: Rle) -> npt.NDArray[np.bool_]:
    """The mask (H, W). Raises InputError for counts that do not fit its size."""
    runs = _runs(rle.counts)
    if runs is None or runs.sum() != rle.height * rle.width:
        raise InputError(f"a mask that does not fit its {rle.width}x{rle.height} px, expected COCO's RLE text")
    return np.repeat(np.arange(runs.size) % 2 == 1, runs).reshape(rle.width, rle.height).T


def mask_area(rle: Rle) -> int:
    """Pixels of the mask."""
    return int(_mask_api().area(rle.as_coco()))


def mask_box(rle: Rle) -> tuple[float, float, float, float]:
    """x, y, width, height of the mask in pixels; all 0 for an empty mask."""
    x, y, width, height = _mask_api().toBbox(rle.as_coco()).tolist()
    return x, y, width, height


def masks_overlap(masks: Sequence[Rle]) -> bool:
    """Whether a pixel belongs to two of the masks of one image."""
    encoded = [mask.as_coco() for mask in masks]
    api = _mask_api()
    return len(encoded) > 1 and int(api.area(api.merge(encoded))) < int(np.sum(api.area(encoded)))


def masks_iou(first: Sequence[Rle], second: Sequence[Rle], *, of_first: bool = False) -> npt.NDArray[np.float64]:
    """Intersection over union of every pair, (len(first), len(second)); over `first`'s own area with `of_first`.

    Raises:
        InputError: masks of different sizes.
    """
    if not first or not second:
        return np.zeros((len(first), len(second)))
    sizes = sorted({(mask.width, mask.height) for mask in (*first, *second)})
    if len(sizes) > 1:
        raise InputError(f"masks of {sizes[0][0]}x{sizes[0][1]} and {sizes[1][0]}x{sizes[1][1]} px, expected one size")
    crowd = [int(of_first)] * len(second)
    encoded = [[mask.as_coco() for mask in masks] for masks in (first, second)]
    return np.asarray(_mask_api().iou(encoded[0], encoded[1], crowd), dtype=np.float64)


def _from_coco(encoded: dict[str, Any]) -> Rle:
    height, width = encoded["size"]
    return Rle(int(height), int(width), encoded["counts"].decode("ascii"))


def _is_polygon(polygon: Any) -> bool:
    return (
        isinstance(polygon, list)
        and len(polygon) >= 6
        and len(polygon) % 2 == 0
        and all(type(value) in (int, float) and abs(value) <= _FARTHEST_PX for value in polygon)
    )


def _runs(text: str) -> npt.NDArray[np.int64] | None:
    # Five bits a letter, the sixth says that more follow; from the fourth count on the difference to the one before
    # the last stands there (pycocotools' maskApi.c, rleFrString).
    letters = np.frombuffer(text.encode("utf-8"), dtype=np.uint8).astype(np.int64) - 48
    if letters.size == 0 or letters.min() < 0 or letters.max() > 63 or letters[-1] & 32:
        return None
    last = np.flatnonzero((letters & 32) == 0)
    first = np.concatenate(([0], last[:-1] + 1))
    place = np.arange(letters.size) - np.repeat(first, last - first + 1)
    if place.max() > 6:
        return None
    values = np.add.reduceat((letters & 31) << (5 * place), first)
    negative = (letters[last] & 16) != 0
    values[negative] -= 1 << (5 * (last - first + 1)[negative])
    values[1::2] = np.cumsum(values[1::2])
    values[2::2] = np.cumsum(values[2::2])
    return None if values.min() < 0 else values


def _mask_api() -> Any:
    try:
        from pycocotools import mask
    except ImportError:
        raise ResourceError("pycocotools is not installed, expected it for masks: pip install pycocotools") from None
    return mask
