# SPDX-License-Identifier: Apache-2.0
"""Which true and found objects of a class are compared in each frame, by the rules of KITTI and of KITTI MOTS."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from services.evaluation.object_tracking.metrics import MatchedFrame
from services.formats.rle import Rle, masks_iou
from services.runtime.errors import InputError

Box = tuple[float, float, float, float]
"""left, top, right, bottom in px"""

# KITTI's devkit: neither of these is the class, and to take one for it is no error.
_DISTRACTORS = {"car": "van", "pedestrian": "person_sitting"}
_MINIMUM_IOU = 0.5
_LARGEST_IGNORED_SHARE = 0.5
_SMALLEST_BOX_PX = 25.0


@dataclass(frozen=True)
class SeenObject:
    """One object in one frame. `hard`: too hidden or cut off to be asked for, as KITTI's labels say."""

    object_id: int
    category: str
    shape: Rle | Box
    hard: bool = False


@dataclass(frozen=True)
class ObjectSequence:
    """Frame by frame, what is seen, and the regions in which nothing found is wrong; of masks or of boxes alone."""

    name: str
    frames: Mapping[int, Sequence[SeenObject]]
    ignored: Mapping[int, Sequence[Rle | Box]] = field(default_factory=dict)

    @property
    def categories(self) -> set[str]:
        """Those of the objects seen."""
        return {item.category for items in self.frames.values() for item in items}


def match_sequence(truth: ObjectSequence, found: ObjectSequence, category: str) -> list[MatchedFrame]:
    """The true and found objects of a class in every frame that holds an object; no measure asks for the others.

    What was found of a hard object or of a class too much alike, in an ignored region, or, of boxes that match
    nothing, what is at most 25 px high, does not count (KITTI tracking; KITTI MOTS for masks, which has no such
    objects and sizes). Raises InputError for masks of different sizes, or masks here and boxes there.
    """
    frames = []
    for number in sorted({*truth.frames, *found.frames}):
        true = [o for o in truth.frames.get(number, ()) if o.category in (category, _DISTRACTORS.get(category))]
        seen = [o for o in found.frames.get(number, ()) if o.category == category]
        try:
            frames.append(_match_frame(true, seen, truth.ignored.get(number, ()), category))
        except InputError as error:
            raise InputError(f"sequence {truth.name} frame {number}: {error}") from None
    return frames


def _match_frame(
    true: Sequence[SeenObject], found: Sequence[SeenObject], ignored: Sequence[Rle | Box], category: str
) -> MatchedFrame:
    iou = shapes_iou([item.shape for item in true], [item.shape for item in found])
    asked = np.array([item.category == category and not item.hard for item in true], dtype=bool)
    rows, columns = linear_sum_assignment(np.where(iou >= _MINIMUM_IOU - np.finfo(float).eps, iou, 0.0), maximize=True)
    real = iou[rows, columns] >= _MINIMUM_IOU - np.finfo(float).eps
    rows, columns = rows[real], columns[real]
    kept = np.ones(len(found), dtype=bool)
    kept[columns[~asked[rows]]] = False
    unmatched = np.setdiff1d(np.arange(len(found)), columns)
    if unmatched.size:
        shapes = [found[place].shape for place in unmatched]
        within = shapes_iou(shapes, ignored, of_first=True)
        excused = (within > _LARGEST_IGNORED_SHARE + np.finfo(float).eps).any(axis=1)
        low = np.array([not isinstance(s, Rle) and s[3] - s[1] <= _SMALLEST_BOX_PX for s in shapes], dtype=bool)
        kept[unmatched[excused | low]] = False
    true_ids = np.array([item.object_id for item in true], dtype=np.int64)
    found_ids = np.array([item.object_id for item in found], dtype=np.int64)
    return MatchedFrame(true_ids[asked], found_ids[kept], iou[asked][:, kept])


def shapes_iou(
    first: Sequence[Rle | Box], second: Sequence[Rle | Box], *, of_first: bool = False
) -> npt.NDArray[np.float64]:
    """Intersection over union of every pair of masks or of boxes; over `first`'s own area with `of_first`.

    Raises:
        InputError: masks and boxes, or masks of different sizes.
    """
    masks = [shape for shape in (*first, *second) if isinstance(shape, Rle)]
    if not masks:
        return _boxes_iou(
            np.array(first, dtype=np.float64).reshape(-1, 4),
            np.array(second, dtype=np.float64).reshape(-1, 4),
            of_first=of_first,
        )
    if len(masks) != len(first) + len(second):
        raise InputError("masks and boxes, expected two of a kind")
    return masks_iou(masks[: len(first)], masks[len(first) :], of_first=of_first)


def _boxes_iou(
    first: npt.NDArray[np.float64], second: npt.NDArray[np.float64], *, of_first: bool
) -> npt.NDArray[np.float64]:
    low = np.maximum(first[:, None, :2], second[None, :, :2])
    high = np.minimum(first[:, None, 2:], second[None, :, 2:])
    both = np.prod((high - low).clip(0), axis=2)
    first_area, second_area = (np.prod(boxes[:, 2:] - boxes[:, :2], axis=1) for boxes in (first, second))
    whole = np.broadcast_to(first_area[:, None], both.shape)
    if not of_first:
        whole = whole + second_area[None] - both
    return np.asarray(np.divide(both, whole, out=np.zeros_like(both), where=whole > 0), dtype=np.float64)
