# SPDX-License-Identifier: Apache-2.0
import pytest
import torch

from services.segmenter.agreement import overlaps, sample_image
from services.segmenter.solov2.instances import SegmentedInstances


def _found(*rows: tuple[int, int, int, float]) -> SegmentedInstances:
    """Stripes of pixels: first, last, category, score."""
    masks = torch.zeros(len(rows), 1, 100, dtype=torch.bool)
    for mask, (first, last, _, _) in zip(masks, rows, strict=True):
        mask[0, first:last] = True
    return SegmentedInstances(masks, torch.tensor([row[2] for row in rows]), torch.tensor([row[3] for row in rows]))


def test_each_sure_instance_is_compared_with_the_best_of_its_category() -> None:
    exact = _found((0, 50, 1, 0.9), (60, 80, 2, 0.5), (80, 90, 2, 0.2))
    other = _found((0, 40, 1, 0.9), (0, 50, 3, 0.8), (60, 80, 2, 0.25), (60, 70, 2, 0.2))
    assert overlaps(exact, other) == pytest.approx([0.8, 1.0])


def test_without_a_sure_one_the_surest_is_compared() -> None:
    exact = _found((0, 50, 1, 0.2), (60, 80, 2, 0.15))
    assert overlaps(exact, _found((0, 50, 1, 0.2))) == [1.0]
    assert overlaps(exact, _found((60, 80, 2, 0.15))) == [0.0]
    assert overlaps(exact, _found()) == [0.0]
    assert overlaps(_found(), exact) == []


def test_there_is_a_sample_to_judge_by() -> None:
    image = sample_image()
    assert image.shape == (540, 960, 3)
    assert image.std() > 20
