# SPDX-License-Identifier: Apache-2.0
"""The two sizes that there are public weights for."""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

Norm = Literal["instance", "batch", "none"]

STRIDE: Final = 8
"""pixels an element of the feature maps"""
LEVELS: Final = 4
"""of the correlation pyramid"""


@dataclass(frozen=True)
class Variant:
    """What the sizes differ in."""

    bottleneck: bool
    """residual blocks of three convolutions, not of two"""
    widths: tuple[int, int, int, int]
    """channels of the stem and of the three stages"""
    feature_channels: int
    hidden_channels: int
    context_channels: int
    context_norm: Norm
    radius: int
    """of the correlations that are looked up, in elements of each level"""
    flow_channels: int
    """within the branch of the motion encoder that sees the flow; half of it comes out"""
    correlation_channels: tuple[int, ...]
    motion_channels: int
    """of the motion encoder's output, without the flow itself"""
    flow_head_channels: int
    learned_upsampling: bool

    @property
    def correlations(self) -> int:
        """Channels that a look-up gives."""
        return LEVELS * (2 * self.radius + 1) ** 2


VARIANTS: Final = MappingProxyType(
    {
        "raft_small": Variant(
            bottleneck=True,
            widths=(32, 32, 64, 96),
            feature_channels=128,
            hidden_channels=96,
            context_channels=64,
            context_norm="none",
            radius=3,
            flow_channels=64,
            correlation_channels=(96,),
            motion_channels=80,
            flow_head_channels=128,
            learned_upsampling=False,
        ),
        "raft_large": Variant(
            bottleneck=False,
            widths=(64, 64, 96, 128),
            feature_channels=256,
            hidden_channels=128,
            context_channels=128,
            context_norm="batch",
            radius=4,
            flow_channels=128,
            correlation_channels=(256, 192),
            motion_channels=126,
            flow_head_channels=256,
            learned_upsampling=True,
        ),
    }
)
