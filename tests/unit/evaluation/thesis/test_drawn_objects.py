# SPDX-License-Identifier: Apache-2.0
"""Polygons to masks: which is in front, what belongs together, what is left."""

import numpy as np
import pytest

from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.thesis.drawn_objects import THESIS_LABELS, DrawnLabel, draw_objects
from services.formats.labelme import LabelmeImage, LabelmeShape
from services.runtime.errors import InputError


def _square(label: str, x: float, y: float, side: float = 10.0, group: int | None = None) -> LabelmeShape:
    corners = [[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    return LabelmeShape(label, np.array(corners), "polygon", group)


def _image(*shapes: LabelmeShape) -> LabelmeImage:
    return LabelmeImage("a.png", 60, 40, shapes)


def test_moving_and_standing_cars_get_their_classes_and_the_later_one_is_in_front() -> None:
    drawn = draw_objects(_image(_square("static_car", 10, 10), _square("moving_car", 15, 10)), THESIS_LABELS)
    assert [(item.label, item.category, item.moving) for item in drawn.instances] == [
        (1, "car", False),
        (2, "car", True),
    ]
    assert (drawn.classes[10:20, 10:15] == MaskClass.NON_MOVING).all()
    assert (drawn.classes[10:20, 15:25] == MaskClass.MOVING).all()
    assert (drawn.classes > 0).sum() == 150


def test_shapes_of_one_group_are_one_object_and_what_is_hidden_is_left_out() -> None:
    shapes = (
        _square("static_car", 30, 10),
        _square("moving_car", 0, 0, group=1),
        _square("moving_car", 0, 20, group=1),
        _square("static_car", 30, 10),
    )
    drawn = draw_objects(_image(*shapes), THESIS_LABELS)
    assert [item.moving for item in drawn.instances] == [True, False]
    assert (drawn.labels[0:10, 0:10] == 1).all()
    assert (drawn.labels[20:30, 0:10] == 1).all()
    assert (drawn.labels[10:20, 30:40] == 2).all()


def test_labels_mean_what_the_user_says_and_unknown_ones_are_named() -> None:
    meanings = {**THESIS_LABELS, "walker": DrawnLabel("person", True), "tree": None}
    drawn = draw_objects(_image(_square("tree", 0, 0), _square("walker", 20, 0)), meanings)
    assert [item.category for item in drawn.instances] == ["person"]
    with pytest.raises(InputError, match="label 'dog': expected one of static_car, moving_car, walker, tree"):
        draw_objects(_image(_square("dog", 0, 0)), meanings)
