# SPDX-License-Identifier: Apache-2.0
"""How alike each place of the first image is to places of the second (section 3.2 of the paper)."""

import math

import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d, grid_sample

from services.motion.flow.raft.variants import LEVELS


class CorrelationPyramid:
    """All pairs of places, the second image's at four sizes.

    Holds 4/3 (H W)^2 numbers for features of H rows and W columns.

    Args:
        first, second: (N, C, H, W) features.
        radius: of the neighbourhood that is looked up, in elements of each level.
    """

    def __init__(self, first: Tensor, second: Tensor, radius: int) -> None:
        count, channels, height, width = first.shape
        pairs = first.flatten(2).transpose(1, 2) @ second.flatten(2) / math.sqrt(channels)
        level = pairs.view(count * height * width, 1, height, width)
        self._levels = [level]
        for _ in range(LEVELS - 1):
            level = avg_pool2d(level, 2, stride=2)
            self._levels.append(level)
        steps = torch.arange(-radius, radius + 1, dtype=first.dtype, device=first.device)
        # the first of both counters goes along x: the order that the authors' weights expect
        x, y = torch.meshgrid(steps, steps, indexing="ij")
        self._neighbours = torch.stack([x, y], dim=-1)

    def around(self, places: Tensor) -> Tensor:
        """Correlations around a place of the second image for each of the first's.

        Args:
            places: (N, 2, H, W), x and y in elements of the features.

        Returns:
            (N, levels (2 radius + 1)^2, H, W); zero beyond the border.
        """
        count, _, height, width = places.shape
        centers = places.permute(0, 2, 3, 1).reshape(count * height * width, 1, 1, 2)
        found = [
            _sampled(level, centers / 2**number + self._neighbours).view(count, height, width, -1)
            for number, level in enumerate(self._levels)
        ]
        return torch.cat(found, dim=-1).permute(0, 3, 1, 2).contiguous()


def _sampled(image: Tensor, places: Tensor) -> Tensor:
    """(N, 1, H, W) at (N, h, w, 2) pixels x, y, bilinear."""
    height, width = image.shape[-2:]
    scale = torch.tensor([2 / max(width - 1, 1), 2 / max(height - 1, 1)], dtype=places.dtype, device=places.device)
    return grid_sample(image, places * scale - 1, align_corners=True)
