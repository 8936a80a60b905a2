# SPDX-License-Identifier: Apache-2.0
"""RoIAlign (section 3 of the paper): the features within a box, on a grid of fixed size, without rounding."""

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d, grid_sample

from services.segmenter.mask_rcnn.boxes import areas

_STRIDES = (4, 8, 16, 32)
_FINEST_PX = 56
_SAMPLES = 2
"""points a side of a bin, which is their mean"""


def roi_align(levels: Sequence[Tensor], boxes: Tensor, size: int) -> Tensor:
    """Features (N, C, size, size) of boxes (N, 4) in image pixels, each out of the level of its size.

    Args:
        levels: (1, C, H / s, W / s) of strides 4, 8, 16, 32.
        boxes: large ones are looked up in coarse levels (Lin et al., CVPR 2017, equation 1).
        size: bins a side.
    """
    level_of = torch.floor(torch.log2(areas(boxes).sqrt() / _FINEST_PX + 1e-6)).clamp(0, len(_STRIDES) - 1)
    out = levels[0].new_zeros((len(boxes), levels[0].shape[1], size, size))
    for number, (features, stride) in enumerate(zip(levels, _STRIDES, strict=False)):
        chosen = (level_of == number).nonzero()[:, 0]
        if len(chosen):
            out[chosen] = _aligned(features, boxes[chosen] / stride, size).to(out.dtype)
    return out


def _aligned(features: Tensor, boxes: Tensor, size: int) -> Tensor:
    """Boxes in elements of the map, whose centres are at halves."""
    count, (height, width) = len(boxes), features.shape[-2:]
    points = size * _SAMPLES
    steps = (torch.arange(points, device=boxes.device) + 0.5) / points
    x = boxes[:, :1] + steps * (boxes[:, 2:3] - boxes[:, :1])
    y = boxes[:, 1:2] + steps * (boxes[:, 3:] - boxes[:, 1:2])
    # one long picture of all boxes' points: the map is not copied for each of them
    grid = torch.stack(
        [
            (2 * x / width - 1)[:, None, :].expand(count, points, points),
            (2 * y / height - 1)[:, :, None].expand(count, points, points),
        ],
        -1,
    ).reshape(1, count * points, points, 2)
    sampled = grid_sample(features, grid.to(features.dtype), padding_mode="border", align_corners=False)
    sampled = sampled.reshape(-1, count, points, points).transpose(0, 1)
    return avg_pool2d(sampled, _SAMPLES)
