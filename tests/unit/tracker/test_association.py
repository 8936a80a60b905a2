# SPDX-License-Identifier: Apache-2.0
"""Which instance is which object."""

import numpy as np
import pytest

from services.tracker.association import Candidate, associate, same_class
from services.tracker.mask_patch import MaskPatch, cut_out, mask_iou


def candidate(x: int, y: int, width: int = 20, height: int = 20, category: str = "car") -> Candidate:
    patch = MaskPatch(x, y, np.ones((height, width), bool))
    return Candidate(category, patch, (float(x), float(y), float(width), float(height)))


def test_iou_of_rectangles() -> None:
    first, second = candidate(0, 0).patch, candidate(10, 0).patch
    assert mask_iou(first, second) == pytest.approx(200 / 600)
    assert mask_iou(first, first) == 1.0
    assert mask_iou(first, candidate(20, 0).patch) == 0.0
    empty = MaskPatch(0, 0, np.zeros((5, 5), bool))
    assert mask_iou(empty, empty) == 0.0


def test_iou_equals_that_of_whole_images() -> None:
    random = np.random.default_rng(8)
    first, second = random.random((40, 60)) > 0.4, random.random((40, 60)) > 0.6
    first[:, :10] = second[:, 50:] = False
    whole = (first & second).sum() / (first | second).sum()
    cut = mask_iou(MaskPatch(10, 0, first[:, 10:]), MaskPatch(0, 0, second[:, :50]))
    assert cut == pytest.approx(whole)


def test_a_patch_is_cut_out_and_stretched() -> None:
    labels = np.zeros((50, 60), np.uint32)
    labels[10:20, 30:50] = 7
    patch = cut_out(labels, 7, (30.0, 10.0, 20.0, 10.0))
    assert (patch.x, patch.y, patch.area_px) == (30, 10, 200)
    bigger = patch.fitted((28.0, 8.0, 40.0, 20.0))
    assert (bigger.x, bigger.y, bigger.area_px) == (28, 8, 800)


def test_the_best_sum_wins_over_the_best_pair() -> None:
    # greedily the second would get its best (IoU 0.67), and the first of before would be left with nothing
    before = [candidate(0, 0), candidate(10, 0)]
    found = [candidate(6, 0), candidate(20, 0)]
    assert associate(before, found) == [(0, 0), (1, 1)]


def test_another_class_is_another_object() -> None:
    assert associate([candidate(0, 0)], [candidate(0, 0, category="person")]) == []
    assert associate([candidate(0, 0)], [candidate(0, 0, category="truck")]) == [(0, 0)]
    assert same_class("bicycle", "motorcycle")
    assert not same_class("person", "bicycle")


def test_thin_things_are_matched_by_distance_when_masks_miss() -> None:
    before, found = [candidate(0, 0, 4, 16, "person")], [candidate(6, 0, 4, 16, "person")]
    assert associate(before, found) == [(0, 0)]
    assert associate(before, [candidate(40, 0, 4, 16, "person")]) == []
    assert associate(before, [candidate(6, 0, 12, 48, "person")]) == []


def test_nothing_to_match() -> None:
    assert associate([], [candidate(0, 0)]) == []
    assert associate([candidate(0, 0)], []) == []
