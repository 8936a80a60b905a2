# SPDX-License-Identifier: Apache-2.0
import math

import pytest
import torch

from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.variants import GRIDS
from services.segmenter.training.losses import BatchTargets, dice_loss, focal_loss, segmentation_loss
from services.segmenter.training.targets import NOBODY


def test_focal_loss_is_equation_3_8() -> None:
    logits, targets = torch.tensor([0.4, -1.3]), torch.tensor([1.0, 0.0])
    p = 1 / (1 + math.exp(-0.4))
    q = 1 - 1 / (1 + math.exp(1.3))  # probability of the right answer, which is no
    expected = -0.25 * (1 - p) ** 2 * math.log(p) - 0.75 * (1 - q) ** 2 * math.log(q)
    assert focal_loss(logits, targets).item() == pytest.approx(expected, rel=1e-5)


def test_dice_loss_is_equation_3_5() -> None:
    predicted = torch.tensor([[0.5, 1.0, 0.0], [0.0, 0.0, 0.0]])
    targets = torch.tensor([[1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    found = dice_loss(predicted, targets)
    assert found.tolist() == pytest.approx([1 - (2 * 1.5 + 1) / (1.25 + 2 + 1), 0.0])


def _targets(cell: tuple[int, int]) -> BatchTargets:
    categories = [torch.full((1, grid, grid), NOBODY) for grid in GRIDS]
    instances = [torch.full((1, grid, grid), NOBODY) for grid in GRIDS]
    categories[2][0][cell], instances[2][0][cell] = 1, 0
    mask = torch.zeros(1, 8, 8)
    mask[0, 2:5, 2:5] = 1
    return BatchTargets(tuple(categories), tuple(instances), (mask,))


def _output(kernel: float, logit: float, cell: tuple[int, int]) -> HeadOutput:
    features = torch.full((1, 2, 8, 8), -1.0)
    features[0, 0, 2:5, 2:5] = 1.0
    features[0, 1] = 0.0
    kernels = [torch.zeros(1, 2, grid, grid) for grid in GRIDS]
    categories = [torch.full((1, 3, grid, grid), -20.0) for grid in GRIDS]
    kernels[2][(0, 0, *cell)] = kernel
    categories[2][(0, 1, *cell)] = logit
    return HeadOutput(tuple(kernels), tuple(categories), features)


def test_the_right_answer_in_the_right_cell_costs_nothing() -> None:
    loss = segmentation_loss(_output(30.0, 20.0, (7, 9)), _targets((7, 9)))
    assert loss.answering_cells == 1
    assert loss.mask.item() == pytest.approx(0, abs=1e-4)
    assert loss.category.item() == pytest.approx(0, abs=1e-4)


def test_the_wrong_mask_and_the_wrong_cell_cost() -> None:
    wrong_mask = segmentation_loss(_output(-30.0, 20.0, (7, 9)), _targets((7, 9)))
    assert wrong_mask.mask.item() == pytest.approx(3 * (1 - 1 / (55 + 9 + 1)), rel=1e-3)
    wrong_cell = segmentation_loss(_output(30.0, 20.0, (9, 7)), _targets((7, 9)))
    # one miss and one false alarm, both sure: 0.25 * 20 + 0.75 * 20 over one answering cell and one
    assert wrong_cell.category.item() == pytest.approx(10.0, rel=1e-3)


def test_an_image_without_instances_has_a_loss_all_the_same() -> None:
    categories = tuple(torch.full((1, grid, grid), NOBODY) for grid in GRIDS)
    loss = segmentation_loss(_output(1.0, 5.0, (0, 0)), BatchTargets(categories, categories, (torch.zeros(0, 8, 8),)))
    assert loss.mask.item() == 0
    assert loss.category.item() > 1
