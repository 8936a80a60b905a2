# SPDX-License-Identifier: Apache-2.0
"""Objects that somebody drew, as masks to train and judge a segmenter of moving objects by (thesis 4.1.3.1)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.evaluation.moving_masks.iou import MaskClass
from services.formats.label_images import LabelledInstance
from services.formats.labelme import LabelmeImage, LabelmeShape
from services.runtime.errors import InputError


@dataclass(frozen=True)
class DrawnLabel:
    """What a label of the drawer's means."""

    category: str
    moving: bool


THESIS_LABELS: Mapping[str, DrawnLabel | None] = {
    "static_car": DrawnLabel("car", False),
    "moving_car": DrawnLabel("car", True),
}
"""None is for a label to be passed over."""


@dataclass(frozen=True)
class DrawnMasks:
    """One image's objects: `labels` (H, W) with 0 for none, i for `instances` of label i."""

    labels: npt.NDArray[np.uint16]
    instances: tuple[LabelledInstance, ...]

    @property
    def classes(self) -> npt.NDArray[np.uint8]:
        """The mask of `MaskClass` (H, W)."""
        value_of = np.zeros(len(self.instances) + 1, dtype=np.uint8)
        for item in self.instances:
            value_of[item.label] = MaskClass.MOVING if item.moving else MaskClass.NON_MOVING
        return np.asarray(value_of[self.labels])


def draw_objects(image: LabelmeImage, meanings: Mapping[str, DrawnLabel | None]) -> DrawnMasks:
    """The objects of one image; where shapes overlap the one drawn later is in front.

    Shapes of one label and group are one object. An object of which nothing is left to see is left out, and the others
    are numbered from 1 in the order in which they were drawn first.

    Raises:
        InputError: a label without a meaning; names it and those that have one.
    """
    number_of: dict[object, int] = {}
    meaning_of: dict[int, DrawnLabel] = {}
    labels = np.zeros((image.height, image.width), dtype=np.uint16)
    for place, shape in enumerate(image.shapes):
        if shape.label not in meanings:
            known = ", ".join(meanings)
            raise InputError(f"label {shape.label!r}: expected one of {known}, or --label {shape.label}=MEANING")
        meaning = meanings[shape.label]
        if meaning is None:
            continue
        number = number_of.setdefault(_object_of(shape, place), len(number_of) + 1)
        meaning_of[number] = meaning
        labels[image.mask(shape)] = number
    seen = [number for number in np.unique(labels).tolist() if number]
    renumbered = np.zeros(len(number_of) + 1, dtype=np.uint16)
    renumbered[seen] = np.arange(1, len(seen) + 1)
    instances = tuple(
        LabelledInstance(label, meaning_of[number].category, 1.0, meaning_of[number].moving)
        for label, number in enumerate(seen, start=1)
    )
    return DrawnMasks(renumbered[labels], instances)


def _object_of(shape: LabelmeShape, place: int) -> object:
    return place if shape.group_id is None else (shape.label, shape.group_id)
