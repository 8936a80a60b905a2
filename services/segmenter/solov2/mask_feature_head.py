# SPDX-License-Identifier: Apache-2.0
"""The mask feature branch: one map for all instances, which their kernels turn into masks."""

from collections import OrderedDict
from collections.abc import Sequence

from torch import Tensor, nn

from services.segmenter.solov2.conv_block import ConvBlock
from services.segmenter.solov2.coordinates import with_coordinates
from services.segmenter.solov2.variants import Variant

_LEVELS = 4
_COORDINATES = 2


class MaskFeatureHead(nn.Module):
    """Brings the four finest levels of the pyramid to the finest one's size, adds them up and mixes the channels."""

    def __init__(self, variant: Variant) -> None:
        super().__init__()
        self.convs_all_levels = nn.ModuleList(_to_finest(level, variant) for level in range(_LEVELS))
        self.conv_pred = ConvBlock(variant.branch_channels, variant.mask_channels, 1)

    def forward(self, levels: Sequence[Tensor]) -> Tensor:
        """Levels of the pyramid, finest first, to (N, mask channels, H / 4, W / 4)."""
        inputs = [*levels[: _LEVELS - 1], with_coordinates(levels[_LEVELS - 1])]
        total = self.convs_all_levels[0](inputs[0])
        for convs, features in zip(self.convs_all_levels[1:], inputs[1:], strict=True):
            total = total + convs(features)
        mixed: Tensor = self.conv_pred(total)
        return mixed


def _to_finest(level: int, variant: Variant) -> nn.Sequential:
    """A block and a doubling of the size for each level in between; the coarsest input has coordinates too."""
    layers: OrderedDict[str, nn.Module] = OrderedDict()
    in_channels = variant.pyramid_channels + (_COORDINATES if level == _LEVELS - 1 else 0)
    for index in range(max(level, 1)):
        layers[f"conv{index}"] = ConvBlock(in_channels, variant.branch_channels)
        in_channels = variant.branch_channels
        if level > 0:
            layers[f"upsample{index}"] = nn.Upsample(scale_factor=2, mode="bilinear", align_corners=False)
    return nn.Sequential(layers)
