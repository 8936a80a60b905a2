# SPDX-License-Identifier: Apache-2.0
"""The convolutional network that both images' features, and the first one's context, come from."""

from typing import cast

from torch import Tensor, nn

from services.motion.flow.raft.variants import Norm, Variant


class Encoder(nn.Module):
    """Stem and three stages of two residual blocks, to an eighth of the size."""

    def __init__(self, variant: Variant, norm: Norm, out_channels: int) -> None:
        super().__init__()
        block = Bottleneck if variant.bottleneck else Residual
        stem, first, second, third = variant.widths
        self.conv1 = nn.Conv2d(3, stem, 7, 2, 3)
        self.norm1 = _norm(norm, stem)
        self.relu1 = nn.ReLU(inplace=True)
        self.layer1 = nn.Sequential(block(stem, first, 1, norm), block(first, first, 1, norm))
        self.layer2 = nn.Sequential(block(first, second, 2, norm), block(second, second, 1, norm))
        self.layer3 = nn.Sequential(block(second, third, 2, norm), block(third, third, 1, norm))
        self.conv2 = nn.Conv2d(third, out_channels, 1)

    def forward(self, images: Tensor) -> Tensor:
        """(N, 3, H, W) in -1..1 to (N, out, H / 8, W / 8)."""
        features = self.relu1(self.norm1(self.conv1(images)))
        return cast(Tensor, self.conv2(self.layer3(self.layer2(self.layer1(features)))))


class Residual(nn.Module):
    """Two 3x3 convolutions beside a shortcut."""

    def __init__(self, in_channels: int, channels: int, stride: int, norm: Norm) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(in_channels, channels, 3, stride, 1)
        self.norm1 = _norm(norm, channels)
        self.conv2 = nn.Conv2d(channels, channels, 3, 1, 1)
        self.norm2 = _norm(norm, channels)
        self.relu = nn.ReLU(inplace=True)
        self.downsample = _shortcut(in_channels, channels, stride, norm)

    def forward(self, features: Tensor) -> Tensor:
        """(N, in, H, W) to (N, channels, H / stride, W / stride)."""
        out = self.relu(self.norm1(self.conv1(features)))
        out = self.relu(self.norm2(self.conv2(out)))
        shortcut = features if self.downsample is None else self.downsample(features)
        return cast(Tensor, self.relu(shortcut + out))


class Bottleneck(nn.Module):
    """1x1 to a quarter of the channels, 3x3, 1x1 to all of them, beside a shortcut."""

    def __init__(self, in_channels: int, channels: int, stride: int, norm: Norm) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(in_channels, channels // 4, 1)
        self.norm1 = _norm(norm, channels // 4)
        self.conv2 = nn.Conv2d(channels // 4, channels // 4, 3, stride, 1)
        self.norm2 = _norm(norm, channels // 4)
        self.conv3 = nn.Conv2d(channels // 4, channels, 1)
        self.norm3 = _norm(norm, channels)
        self.relu = nn.ReLU(inplace=True)
        self.downsample = _shortcut(in_channels, channels, stride, norm)

    def forward(self, features: Tensor) -> Tensor:
        """(N, in, H, W) to (N, channels, H / stride, W / stride)."""
        out = self.relu(self.norm1(self.conv1(features)))
        out = self.relu(self.norm2(self.conv2(out)))
        out = self.relu(self.norm3(self.conv3(out)))
        shortcut = features if self.downsample is None else self.downsample(features)
        return cast(Tensor, self.relu(shortcut + out))


def _shortcut(in_channels: int, channels: int, stride: int, norm: Norm) -> nn.Sequential | None:
    """None where features pass unchanged."""
    if stride == 1:
        return None
    return nn.Sequential(nn.Conv2d(in_channels, channels, 1, stride), _norm(norm, channels))


def _norm(norm: Norm, channels: int) -> nn.Module:
    match norm:
        case "instance":
            return nn.InstanceNorm2d(channels)
        case "batch":
            return nn.BatchNorm2d(channels)
        case "none":
            return nn.Identity()
