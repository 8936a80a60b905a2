# SPDX-License-Identifier: Apache-2.0
"""Masks carried by the flow."""

import numpy as np

from schemas.records import Instance
from services.motion.mask_carrier import CarriedMasks, bounding_box, carry_masks


def masks() -> CarriedMasks:
    labels = np.zeros((60, 80), np.uint32)
    labels[10:30, 20:40] = 4
    labels[40:50, 60:80] = 70_000
    return CarriedMasks(
        labels, (Instance(4, "car", 0.9, (20, 10, 20, 20)), Instance(70_000, "person", 0.5, (60, 40, 20, 10))), 0
    )


def flow(right: float, down: float) -> np.ndarray:
    field = np.zeros((60, 80, 2), np.float32)
    field[...] = (-right, -down)
    return field


def test_masks_move_with_the_flow_and_grow_older() -> None:
    carried = carry_masks(masks(), flow(5.0, 2.0))
    assert carried.age_frames == 1
    assert carried.instances[0].box_px == (25.0, 12.0, 20.0, 20.0)
    assert np.count_nonzero(carried.labels == 4) == 400
    assert set(np.unique(carried.labels)) == {0, 4, 70_000}
    assert carry_masks(carried, flow(5.0, 2.0)).instances[0].box_px == (30.0, 14.0, 20.0, 20.0)


def test_what_leaves_the_image_is_gone() -> None:
    carried = carry_masks(masks(), flow(19.0, 0.0))
    assert [instance.instance_id for instance in carried.instances] == [4]
    assert 70_000 not in carried.labels
    assert not carried.labels[:, :19].any()


def test_masks_of_before_are_left_alone() -> None:
    before = masks()
    carry_masks(before, flow(60.0, 0.0))
    assert before.labels[15, 25] == 4
    assert len(before.instances) == 2


def test_bounding_box_of_scattered_pixels() -> None:
    mask = np.zeros((20, 30), bool)
    mask[3, 5] = mask[10, 28] = True
    assert bounding_box(mask) == (5.0, 3.0, 24.0, 8.0)
