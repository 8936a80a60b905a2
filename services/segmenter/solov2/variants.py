# SPDX-License-Identifier: Apache-2.0
"""The configurations of SOLOv2, those that there are public weights for and a smaller one, and their numbers."""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

GRIDS: Final = (40, 36, 24, 16, 12)
"""Cells a side of the grid that an instance's centre falls in, per level, fine to coarse."""

STRIDES: Final = (8, 8, 16, 32, 32)
"""Pixels an element of the feature map that each level's grid is laid over."""


@dataclass(frozen=True)
class Variant:
    """What one configuration differs in from the others.

    `backbone`: of backbones.BACKBONES.
    `scale_ranges_px`: the square root of an instance's area (box) that a level learns, one pair a level.
    `test_size`: the box (width, height) that an image is fitted into.
    `pyramid_channels`, `branch_channels`: of the feature pyramid and within the mask feature branch.
    `least_area`: elements of the mask features that a mask must cover more of, by its level's stride; what is
    smaller is no instance.
    """

    backbone: str
    stacked_convs: int
    feature_channels: int
    mask_channels: int
    scale_ranges_px: tuple[tuple[int, int], ...]
    test_size: tuple[int, int]
    pyramid_channels: int = 256
    branch_channels: int = 128
    least_area: float = 1.0

    @property
    def kernel_channels(self) -> int:
        """Elements of a dynamic 1x1 convolution."""
        return self.mask_channels


_FULL_RANGES = ((1, 96), (48, 192), (96, 384), (192, 768), (384, 2048))
_LIGHT_RANGES = ((1, 56), (28, 112), (56, 224), (112, 448), (224, 896))


def _full(depth: int) -> Variant:
    return Variant(f"resnet{depth}", 4, 512, 256, _FULL_RANGES, (1333, 800))


def _light(depth: int) -> Variant:
    return Variant(f"resnet{depth}", 2, 256, 128, _LIGHT_RANGES, (852, 448))


def _compact() -> Variant:
    return Variant(
        "efficientnet-lite0",
        2,
        128,
        64,
        _LIGHT_RANGES,
        (1056, 544),
        pyramid_channels=96,
        branch_channels=64,
        least_area=0.25,
    )


VARIANTS: Final = MappingProxyType(
    {
        "solov2-compact_lite0": _compact(),
        "solov2-light_r18": _light(18),
        "solov2-light_r34": _light(34),
        "solov2-light_r50": _light(50),
        "solov2_r50": _full(50),
        "solov2_r101": _full(101),
    }
)
