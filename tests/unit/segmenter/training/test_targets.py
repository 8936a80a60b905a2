# SPDX-License-Identifier: Apache-2.0
import numpy as np
import torch
from torch.nn.functional import interpolate

from services.segmenter.solov2.variants import GRIDS, VARIANTS
from services.segmenter.training.sample import Sample
from services.segmenter.training.targets import NOBODY, assign

LIGHT = VARIANTS["solov2-light_r18"]


def _sample(*boxes: tuple[int, int, int, int, int]) -> Sample:
    """x, y, width, height, label each, in an image of 320x160."""
    masks = np.zeros((len(boxes), 160, 320), np.uint8)
    for mask, (x, y, width, height, _) in zip(masks, boxes, strict=True):
        mask[y : y + height, x : x + width] = 1
    return Sample(np.zeros((160, 320, 3), np.uint8), masks, np.array([box[4] for box in boxes], np.int64))


def test_an_instance_belongs_to_the_levels_of_its_size() -> None:
    targets = assign(_sample((100, 60, 60, 40, 3)), LIGHT)  # 49 px: the first two levels
    answering = [int((grid != NOBODY).sum()) for grid in targets.categories]
    assert answering[0] > 0
    assert answering[1] > 0
    assert answering[2:] == [0, 0, 0]
    assert set(targets.categories[0][targets.categories[0] != NOBODY]) == {3}


def test_cells_in_the_middle_of_the_instance_answer() -> None:
    targets = assign(_sample((100, 60, 60, 40, 3)), LIGHT)
    rows, columns = np.nonzero(targets.instances[0] == 0)
    # centre (129.5, 79.5) px; 40 cells of 8 x 4 px; a fifth of the box is +-6 px and +-4 px
    assert (columns.min(), columns.max()) == (15, 16)
    assert (rows.min(), rows.max()) == (18, 20)


def test_of_two_that_claim_a_cell_the_smaller_has_it() -> None:
    boxes = ((100, 60, 40, 40, 1), (102, 62, 36, 36, 2))
    for order in (boxes, boxes[::-1]):
        targets = assign(_sample(*order), LIGHT)
        assert targets.categories[0][19, 15] == 2
        assert targets.instances[0][19, 15] == order.index(boxes[1])


def test_masks_are_a_quarter_of_the_size_and_say_shares() -> None:
    targets = assign(_sample((4, 8, 10, 8, 0)), LIGHT)
    assert targets.masks.shape == (1, 40, 80)
    np.testing.assert_array_equal(targets.masks[0, 2, :5], [0, 1, 1, 0.5, 0])
    assert targets.masks.sum() * 16 == 10 * 8


def test_an_outline_between_the_elements_is_kept() -> None:
    sample = _sample((101, 62, 38, 21, 0))
    reduced = torch.from_numpy(assign(sample, LIGHT).masks)
    enlarged = interpolate(reduced[None], scale_factor=4, mode="bilinear", align_corners=False)[0, 0] > 0.5
    true = torch.from_numpy(sample.masks[0]) > 0
    assert (enlarged & true).sum() / (enlarged | true).sum() > 0.95


def test_no_instance_no_answer() -> None:
    targets = assign(_sample(), LIGHT)
    assert all((grid == NOBODY).all() for grid in targets.categories)
    assert [grid.shape for grid in targets.categories] == [(grid, grid) for grid in GRIDS]
    assert targets.masks.shape == (0, 40, 80)


def test_nobody_answers_for_what_the_mask_features_cannot_show() -> None:
    targets = assign(_sample((101, 60, 1, 60, 0)), LIGHT)
    assert all((grid == NOBODY).all() for grid in targets.categories)
