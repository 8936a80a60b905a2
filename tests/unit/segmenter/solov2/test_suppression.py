# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest
import torch

from services.segmenter.solov2.matrix_nms import matrix_nms
from services.segmenter.solov2.points_nms import points_nms


def _iou(a: np.ndarray, b: np.ndarray) -> float:
    return float((a & b).sum() / (a | b).sum())


def test_matrix_nms_is_equation_5_of_the_paper() -> None:
    random = np.random.default_rng(3)
    masks = random.random((12, 9, 11)) < 0.6
    labels = random.integers(0, 3, 12)
    scores = np.sort(random.random(12))[::-1].copy()
    expected = []
    for j in range(12):
        decay = 1.0
        for i in range(j):
            iou = _iou(masks[i], masks[j]) if labels[i] == labels[j] else 0.0
            covers = [_iou(masks[k], masks[i]) for k in range(i) if labels[k] == labels[i]]
            decay = min(decay, math.exp(-2 * iou**2) / math.exp(-2 * max(covers, default=0.0) ** 2))
        expected.append(scores[j] * decay)
    found = matrix_nms(torch.from_numpy(masks), torch.from_numpy(labels), torch.from_numpy(scores))
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_a_duplicate_loses_its_score_and_another_category_does_not() -> None:
    mask = torch.zeros(3, 8, 8, dtype=torch.bool)
    mask[:, 2:6, 2:6] = True
    found = matrix_nms(mask, torch.tensor([1, 1, 2]), torch.tensor([0.9, 0.8, 0.7]))
    assert found.tolist() == pytest.approx([0.9, 0.8 * math.exp(-2), 0.7])


def test_points_nms_keeps_the_surest_of_two_neighbours() -> None:
    scores = torch.zeros(1, 1, 5, 5)
    scores[0, 0, 2, 2], scores[0, 0, 2, 3], scores[0, 0, 4, 0] = 0.9, 0.8, 0.3
    kept = points_nms(scores)
    assert kept[0, 0, 2, 2] == pytest.approx(0.9)
    assert kept[0, 0, 2, 3] == 0
    assert kept[0, 0, 4, 0] == pytest.approx(0.3)
