# SPDX-License-Identifier: Apache-2.0
"""Matrix NMS: duplicates of an instance lose their score, all at once (section 3.4 of the paper)."""

import torch
from torch import Tensor


def matrix_nms(masks: Tensor, labels: Tensor, scores: Tensor, sigma: float = 2.0) -> Tensor:
    """The scores, each lowered by how much a surer mask of the same category covers it (gaussian kernel).

    Args:
        masks: (M, H, W) bool, surest first, none of them empty.
        labels: (M,) categories.
        scores: (M,).
        sigma: of the gaussian.
    """
    count = len(labels)
    flat = masks.reshape(count, -1).to(scores.dtype)
    shared = flat @ flat.T
    areas = shared.diagonal()
    iou = shared / (areas[:, None] + areas[None, :] - shared)
    iou = torch.where(labels[:, None] == labels[None, :], iou, torch.zeros_like(iou)).triu(diagonal=1)
    # a suppressor that is itself suppressed counts for less: f(iou of j and i) / f(largest iou of i)
    suppressed = iou.amax(dim=0)
    decay = torch.exp(-sigma * (iou.square() - suppressed.square()[:, None])).amin(dim=0)
    return scores * decay
