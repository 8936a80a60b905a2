# SPDX-License-Identifier: Apache-2.0
"""Instances out of head outputs that were made by hand: one bright blob of mask features, one sure cell."""

import torch

from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.instances import instances_of
from services.segmenter.solov2.variants import GRIDS


def _output(category_logit: float) -> HeadOutput:
    features = torch.full((1, 2, 16, 24), -4.0)
    features[0, 0, 4:12, 6:18] = 4.0  # the object
    kernels = [torch.zeros(1, 2, grid, grid) for grid in GRIDS]
    categories = [torch.full((1, 3, grid, grid), -9.0) for grid in GRIDS]
    kernels[1][0, 0, 18, 17] = 2.0
    categories[1][0, 2, 18, 17] = category_logit
    return HeadOutput(tuple(kernels), tuple(categories), features)


def test_a_sure_cell_gives_its_mask_in_the_images_size() -> None:
    found = instances_of(_output(3.0), (60, 90), (120, 180))
    assert found.labels.tolist() == [2]
    assert 0.94 < float(found.scores[0]) <= 0.953  # sigmoid(3) times a mask that is almost sure
    assert found.masks.shape == (1, 120, 180)
    rows, columns = found.masks[0].nonzero(as_tuple=True)
    # 4 px an element of the mask features, doubled by the enlargement; the padding is cut off before it
    assert (int(rows.min()), int(rows.max())) == (32, 95)
    assert (int(columns.min()), int(columns.max())) == (48, 143)


def test_no_sure_cell_gives_nothing() -> None:
    found = instances_of(_output(-5.0), (60, 90), (120, 180))
    assert found.masks.shape == (0, 120, 180)
    assert len(found.scores) == 0


def test_a_mask_smaller_than_its_cells_stride_is_left_out() -> None:
    output = _output(3.0)
    output.mask_features[0, 0] = -4.0
    output.mask_features[0, 0, 5, 5:12] = 4.0  # 7 elements, 8 px a cell of that level
    assert len(instances_of(output, (60, 90), (120, 180)).scores) == 0
