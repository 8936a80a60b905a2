# SPDX-License-Identifier: Apache-2.0
"""The backbones by name, and what they have in common."""

from collections.abc import Callable, Sequence
from types import MappingProxyType
from typing import Final

from torch import nn

from services.segmenter.solov2.efficientnet_lite import EfficientNetLite
from services.segmenter.solov2.resnet import DEPTHS, ResNet

Backbone = ResNet | EfficientNetLite


def _resnet(depth: int) -> Callable[[], Backbone]:
    return lambda: ResNet(depth)


BACKBONES: Final = MappingProxyType(
    {"efficientnet-lite0": EfficientNetLite, **{f"resnet{depth}": _resnet(depth) for depth in DEPTHS}}
)


def early_part(backbone: Backbone) -> Sequence[nn.Module]:
    """What finds edges and textures, up to stride 4: alike for all images, so that it need not be learned again."""
    if isinstance(backbone, ResNet):
        return (backbone.conv1, backbone.bn1, backbone.layer1)
    return (backbone.stem, *backbone.stages[:2])
