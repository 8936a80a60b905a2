# SPDX-License-Identifier: Apache-2.0
"""Points-NMS: of neighbouring cells that see one object, the surest speaks (section 3.3 of the paper)."""

from torch import Tensor
from torch.nn.functional import max_pool2d


def points_nms(scores: Tensor) -> Tensor:
    """Scores (N, categories, S, S) with 0 wherever the left, upper or upper left neighbour is surer."""
    largest = max_pool2d(scores, 2, stride=1, padding=1)[:, :, :-1, :-1]
    return scores * (largest == scores)
