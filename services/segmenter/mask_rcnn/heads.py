# SPDX-License-Identifier: Apache-2.0
"""What is in a box: its category and a better box, and the mask within it."""

from torch import Tensor, nn

_BOX_SIZE, _HIDDEN = 7, 1024
_MASK_CONVS = 4


class BoxHead(nn.Module):
    """Two layers over the features of a box; the last category is the background."""

    def __init__(self, channels: int, categories: int) -> None:
        super().__init__()
        self.shared_fcs = nn.ModuleList([nn.Linear(channels * _BOX_SIZE**2, _HIDDEN), nn.Linear(_HIDDEN, _HIDDEN)])
        self.fc_cls = nn.Linear(_HIDDEN, categories + 1)
        self.fc_reg = nn.Linear(_HIDDEN, 4 * categories)

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """(N, C, 7, 7) to logits (N, categories + 1) and one change of the box a category (N, categories, 4)."""
        hidden = features.flatten(1)
        for layer in self.shared_fcs:
            hidden = layer(hidden).relu()
        return self.fc_cls(hidden), self.fc_reg(hidden).unflatten(1, (-1, 4))


class _Conv(nn.Module):
    """A convolution alone, under the name that checkpoints have it by."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(self, features: Tensor) -> Tensor:
        """Height and width stay."""
        out: Tensor = self.conv(features).relu()
        return out


class MaskHead(nn.Module):
    """Convolutions over the features of a box, and one mask a category."""

    def __init__(self, channels: int, categories: int) -> None:
        super().__init__()
        self.convs = nn.ModuleList(_Conv(channels) for _ in range(_MASK_CONVS))
        self.upsample = nn.ConvTranspose2d(channels, channels, 2, stride=2)
        self.conv_logits = nn.Conv2d(channels, categories, 1)

    def forward(self, features: Tensor) -> Tensor:
        """(N, C, 14, 14) to logits (N, categories, 28, 28)."""
        for conv in self.convs:
            features = conv(features)
        out: Tensor = self.conv_logits(self.upsample(features).relu())
        return out


class RoiHead(nn.Module):
    """Both heads, under the names that checkpoints have them by."""

    def __init__(self, channels: int, categories: int) -> None:
        super().__init__()
        self.bbox_head = BoxHead(channels, categories)
        self.mask_head = MaskHead(channels, categories)
