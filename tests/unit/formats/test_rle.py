# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra import numpy as arrays

from services.formats.rle import (
    Rle,
    checked_rle,
    decode_mask,
    encode_mask,
    mask_area,
    mask_box,
    masks_iou,
    masks_overlap,
    rle_from_coco,
)
from services.runtime.errors import InputError


@settings(max_examples=60, deadline=None)
@given(arrays.arrays(np.bool_, arrays.array_shapes(min_dims=2, max_dims=2, max_side=40)))
def test_every_mask_comes_back_and_passes_the_check(mask: np.ndarray) -> None:
    rle = encode_mask(mask)
    assert checked_rle(rle.height, rle.width, rle.counts) == rle
    np.testing.assert_array_equal(decode_mask(rle), mask)
    assert mask_area(rle) == mask.sum()


def test_a_large_mask_passes_the_check() -> None:
    mask = np.zeros((2000, 3000), dtype=bool)
    mask[:, 1500:] = True
    rle = encode_mask(mask)
    assert checked_rle(2000, 3000, rle.counts) == rle


@pytest.mark.parametrize("counts", ["", "zzz", "0", "PPYo1", "é", "\x01", "PPPPPPPPPPP1"])
def test_counts_that_do_not_fit_are_refused(counts: str) -> None:
    with pytest.raises(InputError, match="expected"):
        checked_rle(10, 10, counts)


def test_box_is_x_y_width_height() -> None:
    mask = np.zeros((20, 30), dtype=bool)
    mask[3:8, 10:12] = True
    assert mask_box(encode_mask(mask)) == (10.0, 3.0, 2.0, 5.0)


def test_polygons_and_plain_counts_are_read() -> None:
    square = rle_from_coco([[2, 2, 8, 2, 8, 8, 2, 8]], 10, 12)
    assert (square.height, square.width, mask_area(square)) == (10, 12, 36)
    plain = rle_from_coco({"size": [2, 3], "counts": [1, 2, 3]}, 2, 3)
    np.testing.assert_array_equal(decode_mask(plain), [[False, True, False], [True, False, False]])


@pytest.mark.parametrize(
    "segmentation",
    [
        None,
        [],
        [[1, 2, 3, 4]],
        [[1, 2, float("nan"), 4, 5, 6]],
        {"size": [2, 3], "counts": [1, 2]},
        {"size": [2, 3], "counts": [7, -1]},
        {"size": [4, 4], "counts": [16]},
    ],
)
def test_what_is_no_mask_is_refused(segmentation: object) -> None:
    with pytest.raises(InputError, match="expected"):
        rle_from_coco(segmentation, 2, 3)


def test_iou_and_overlap() -> None:
    first, second = np.zeros((4, 4)), np.zeros((4, 4))
    first[:, :2] = 1
    second[:, 1:3] = 1
    masks = [encode_mask(first), encode_mask(second)]
    np.testing.assert_allclose(masks_iou(masks, masks), [[1, 1 / 3], [1 / 3, 1]])
    np.testing.assert_allclose(masks_iou(masks[:1], masks[1:], of_first=True), [[0.5]])
    assert masks_iou([], masks).shape == (0, 2)
    assert masks_overlap(masks)
    assert not masks_overlap([encode_mask(first), encode_mask(1 - first)])
    assert not masks_overlap([])


def test_an_empty_mask_has_no_box() -> None:
    empty = encode_mask(np.zeros((3, 4)))
    assert isinstance(empty, Rle)
    assert mask_box(empty) == (0.0, 0.0, 0.0, 0.0)


def test_masks_of_different_sizes_are_not_compared() -> None:
    with pytest.raises(InputError, match="masks of 4x3 and 5x3 px, expected one size"):
        masks_iou([encode_mask(np.ones((3, 4)))], [encode_mask(np.ones((3, 5)))])
