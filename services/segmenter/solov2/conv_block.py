# SPDX-License-Identifier: Apache-2.0
"""The block that the head is built of."""

from torch import Tensor, nn

GROUPS = 32


class ConvBlock(nn.Module):
    """Convolution, group normalisation (Wu and He, ECCV 2018), ReLU; height and width stay."""

    def __init__(self, in_channels: int, out_channels: int, kernel_size: int = 3) -> None:
        super().__init__()
        self.conv = nn.Conv2d(in_channels, out_channels, kernel_size, padding=kernel_size // 2, bias=False)
        self.gn = nn.GroupNorm(GROUPS, out_channels)

    def forward(self, features: Tensor) -> Tensor:
        """(N, in, H, W) to (N, out, H, W)."""
        return nn.functional.relu(self.gn(self.conv(features)), inplace=True)
