# SPDX-License-Identifier: Apache-2.0
"""Region proposals (Ren et al., NeurIPS 2015): boxes that hold an object, whatever it is."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from services.segmenter.mask_rcnn.boxes import areas, decode, suppressed

_RATIOS = (0.5, 1.0, 2.0)
_SCALE = 8
_STRIDES = (4, 8, 16, 32, 64)
_STDS = (1.0, 1.0, 1.0, 1.0)
_MOST_A_LEVEL = 1000
MOST_PROPOSALS = 1000
_MOST_IOU = 0.7


class RegionProposals(nn.Module):
    """Three anchors a cell of each level of the pyramid; heights over widths are 0.5, 1 and 2."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.rpn_conv = nn.Conv2d(channels, channels, 3, padding=1)
        self.rpn_cls = nn.Conv2d(channels, len(_RATIOS), 1)
        self.rpn_reg = nn.Conv2d(channels, 4 * len(_RATIOS), 1)

    def forward(self, levels: Sequence[Tensor], image_hw: tuple[int, int]) -> Tensor:
        """Five levels (1, C, H / s, W / s) to at most MOST_PROPOSALS boxes (N, 4), surest first."""
        boxes, scores, numbers = [], [], []
        for number, (features, stride) in enumerate(zip(levels, _STRIDES, strict=True)):
            hidden = self.rpn_conv(features).relu()
            sure = self.rpn_cls(hidden)[0].permute(1, 2, 0).flatten().float().sigmoid()
            deltas = self.rpn_reg(hidden)[0].permute(1, 2, 0).reshape(-1, 4).float()
            first = torch.sort(sure, descending=True, stable=True).indices[:_MOST_A_LEVEL]
            found = decode(_anchors(features, stride)[first], deltas[first], _STDS, image_hw)
            boxes.append(found)
            scores.append(sure[first])
            numbers.append(torch.full_like(first, number))
        every, sure, level = torch.cat(boxes), torch.cat(scores), torch.cat(numbers)
        there = areas(every) > 0
        every, sure, level = every[there], sure[there], level[there]
        return every[suppressed(every, sure, level, _MOST_IOU)[:MOST_PROPOSALS]]


def _anchors(features: Tensor, stride: int) -> Tensor:
    """(H W A, 4) around the upper left corners of the cells."""
    height, width = features.shape[-2:]
    ratios = torch.tensor(_RATIOS, device=features.device)
    half_h, half_w = stride * _SCALE * ratios.sqrt() / 2, stride * _SCALE / ratios.sqrt() / 2
    around = torch.stack([-half_w, -half_h, half_w, half_h], -1)
    y, x = torch.meshgrid(
        torch.arange(height, device=features.device) * stride,
        torch.arange(width, device=features.device) * stride,
        indexing="ij",
    )
    corners = torch.stack([x, y, x, y], -1).reshape(-1, 1, 4)
    return (corners + around).reshape(-1, 4).to(torch.float32)
