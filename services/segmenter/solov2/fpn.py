# SPDX-License-Identifier: Apache-2.0
"""Feature pyramid network (Lin et al., CVPR 2017)."""

from collections.abc import Sequence

from torch import Tensor, nn
from torch.nn.functional import interpolate, max_pool2d

LEVELS = 5


class _Conv(nn.Module):
    """A convolution alone, under the name that checkpoints have it by."""

    def __init__(self, in_channels: int, out_channels: int, kernel_size: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(in_channels, out_channels, kernel_size, padding=kernel_size // 2)

    def forward(self, features: Tensor) -> Tensor:
        """(N, in, H, W) to (N, out, H, W)."""
        out: Tensor = self.conv(features)
        return out


class Fpn(nn.Module):
    """Passes what the coarse maps know down to the fine ones; one level more is the coarsest, subsampled."""

    def __init__(self, in_channels: Sequence[int], channels: int) -> None:
        super().__init__()
        self.lateral_convs = nn.ModuleList(_Conv(count, channels, 1) for count in in_channels)
        self.fpn_convs = nn.ModuleList(_Conv(channels, channels, 3) for _ in in_channels)

    def forward(self, maps: Sequence[Tensor]) -> tuple[Tensor, ...]:
        """Four maps, finest first, to LEVELS maps (N, channels, H / s, W / s), s = 4, 8, 16, 32, 64."""
        merged = [lateral(features) for lateral, features in zip(self.lateral_convs, maps, strict=True)]
        for fine in range(len(merged) - 2, -1, -1):
            merged[fine] = merged[fine] + interpolate(merged[fine + 1], size=merged[fine].shape[-2:], mode="nearest")
        levels = [conv(features) for conv, features in zip(self.fpn_convs, merged, strict=True)]
        return (*levels, max_pool2d(levels[-1], 1, stride=2))
