# SPDX-License-Identifier: Apache-2.0
"""The head: per cell of a grid what is there (category branch) and the kernel that makes its mask (kernel branch)."""

from collections.abc import Sequence
from typing import NamedTuple

from torch import Tensor, nn
from torch.nn.functional import interpolate

from services.segmenter.solov2.conv_block import ConvBlock
from services.segmenter.solov2.coordinates import with_coordinates
from services.segmenter.solov2.mask_feature_head import MaskFeatureHead
from services.segmenter.solov2.variants import GRIDS, Variant


class HeadOutput(NamedTuple):
    """What the network says of N images; S runs over variants.GRIDS."""

    kernels: tuple[Tensor, ...]
    """(N, mask channels, S, S) each"""
    categories: tuple[Tensor, ...]
    """logits (N, categories, S, S) each"""
    mask_features: Tensor
    """(N, mask channels, H / 4, W / 4)"""


class SoloV2Head(nn.Module):
    """Both branches share their weights over the levels (section 3 of the paper)."""

    def __init__(self, variant: Variant, categories: int) -> None:
        super().__init__()
        channels, stacked = variant.feature_channels, variant.stacked_convs
        self.mask_feature_head = MaskFeatureHead(variant)
        self.cls_convs = _stack(variant.pyramid_channels, channels, stacked)
        self.kernel_convs = _stack(variant.pyramid_channels + 2, channels, stacked)
        self.conv_cls = nn.Conv2d(channels, categories, 3, padding=1)
        self.conv_kernel = nn.Conv2d(channels, variant.kernel_channels, 3, padding=1)

    def forward(self, levels: Sequence[Tensor]) -> HeadOutput:
        """Five levels of the pyramid, finest first."""
        kernels, categories = [], []
        for features, grid in zip(_resized(levels), GRIDS, strict=True):
            cells = interpolate(with_coordinates(features), size=(grid, grid), mode="bilinear", align_corners=False)
            kernels.append(self.conv_kernel(self.kernel_convs(cells)))
            categories.append(self.conv_cls(self.cls_convs(cells[:, :-2])))
        return HeadOutput(tuple(kernels), tuple(categories), self.mask_feature_head(levels))


def _stack(in_channels: int, channels: int, count: int) -> nn.Sequential:
    return nn.Sequential(*(ConvBlock(in_channels if i == 0 else channels, channels) for i in range(count)))


def _resized(levels: Sequence[Tensor]) -> list[Tensor]:
    """The finest level halved and the coarsest enlarged: strides 8, 8, 16, 32, 32."""
    finest, *middle, coarsest = levels
    halved = interpolate(finest, size=middle[0].shape[-2:], mode="bilinear", align_corners=False)
    enlarged = interpolate(coarsest, size=middle[-1].shape[-2:], mode="bilinear", align_corners=False)
    return [halved, *middle, enlarged]
