# SPDX-License-Identifier: Apache-2.0
import pytest
import torch

from services.segmenter.agreement import overlaps, sample_images
from services.segmenter.solov2.instances import SegmentedInstances


def _found(*rows: tuple[int, int, int, float]) -> SegmentedInstances:
    """Stripes of pixels: first, last, category, score."""
    masks = torch.zeros(len(rows), 1, 100, dtype=torch.bool)
    for mask, (first, last, _, _) in zip(masks, rows, strict=True):
        mask[0, first:last] = True
    return SegmentedInstances(masks, torch.tensor([row[2] for row in rows]), torch.tensor([row[3] for row in rows]))


def test_each_sure_instance_is_compared_with_the_best_of_its_category() -> None:
    exact = _found((0, 50, 1, 0.9), (60, 80, 2, 0.5), (0, 5, 1, 0.3), (80, 90, 2, 0.2))
    other = _found((0, 40, 1, 0.9), (0, 50, 3, 0.8), (60, 80, 2, 0.25), (60, 70, 2, 0.2))
    assert overlaps(exact, other) == pytest.approx([0.8, 1.0, 0.125])


def test_the_surest_few_are_compared_in_any_case() -> None:
    exact = _found((0, 50, 1, 0.2), (60, 80, 2, 0.15), (80, 90, 2, 0.12), (90, 100, 2, 0.11))
    assert overlaps(exact, exact) == [1.0, 1.0, 1.0]
    assert overlaps(exact, _found((60, 80, 2, 0.15))) == [0.0, 1.0, 0.0]
    assert overlaps(exact, _found()) == [0.0, 0.0, 0.0]
    assert overlaps(_found(), exact) == []


def test_there_are_samples_to_judge_by() -> None:
    images = sample_images()
    assert {image.shape for image in images} == {(540, 960, 3)}
    assert all(image.std() > 20 for image in images)
    assert len({image.tobytes() for image in images}) == len(images)
