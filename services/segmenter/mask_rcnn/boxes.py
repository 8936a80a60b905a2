# SPDX-License-Identifier: Apache-2.0
"""Boxes (x1, y1, x2, y2) in pixels: how they are coded, and which of them say the same."""

import math

import numpy as np
import torch
from torch import Tensor

_MOST_SCALING = abs(math.log(16 / 1000))


def decode(
    anchors: Tensor, deltas: Tensor, stds: tuple[float, float, float, float], image_hw: tuple[int, int]
) -> Tensor:
    """Boxes out of what the network says relative to anchors (Ren et al., NeurIPS 2015, equation 2), cut at the image.

    Args:
        anchors: (N, 4).
        deltas: (N, 4) shift of the centre by size, logarithm of the scaling, both in units of `stds`.
        stds: see there.
        image_hw: size of the image.
    """
    shift_x, shift_y, scale_x, scale_y = (deltas * deltas.new_tensor(stds)).unbind(-1)
    width, height = anchors[:, 2] - anchors[:, 0], anchors[:, 3] - anchors[:, 1]
    x = (anchors[:, 0] + anchors[:, 2]) / 2 + shift_x * width
    y = (anchors[:, 1] + anchors[:, 3]) / 2 + shift_y * height
    half_w = width * scale_x.clamp(-_MOST_SCALING, _MOST_SCALING).exp() / 2
    half_h = height * scale_y.clamp(-_MOST_SCALING, _MOST_SCALING).exp() / 2
    boxes = torch.stack([x - half_w, y - half_h, x + half_w, y + half_h], -1)
    return cut(boxes, image_hw)


def cut(boxes: Tensor, image_hw: tuple[int, int]) -> Tensor:
    """Boxes without what lies beyond the image."""
    height, width = image_hw
    return torch.stack([boxes[:, 0::2].clamp(0, width), boxes[:, 1::2].clamp(0, height)], -1).flatten(1)


def areas(boxes: Tensor) -> Tensor:
    """(N,), 0 for those that are turned inside out."""
    return (boxes[:, 2] - boxes[:, 0]).clamp(min=0) * (boxes[:, 3] - boxes[:, 1]).clamp(min=0)


def pairwise_iou(boxes: Tensor) -> Tensor:
    """(N, N) intersection over union."""
    first, second = boxes[:, None], boxes[None]
    upper, lower = torch.maximum(first[..., :2], second[..., :2]), torch.minimum(first[..., 2:], second[..., 2:])
    shared = (lower - upper).clamp(min=0).prod(-1)
    area = areas(boxes)
    return shared / (area[:, None] + area[None] - shared).clamp(min=1e-6)


def suppressed(boxes: Tensor, scores: Tensor, groups: Tensor, most_iou: float) -> Tensor:
    """Greedy non-maximum suppression within groups: indices of the boxes that are left, surest first."""
    order = torch.sort(scores, descending=True, stable=True).indices
    boxes, groups = boxes[order], groups[order]
    hides = (pairwise_iou(boxes) > most_iou) & (groups[:, None] == groups[None])
    rows = hides.cpu().numpy()
    gone = np.zeros(len(rows), bool)
    kept = []
    for place, row in enumerate(rows):
        if not gone[place]:
            kept.append(place)
            gone |= row
    return order[torch.tensor(kept, dtype=torch.long, device=order.device)]
