# SPDX-License-Identifier: Apache-2.0
"""The whole network."""

from collections.abc import Sequence

from torch import Tensor, nn

from services.segmenter.solov2.backbones import BACKBONES
from services.segmenter.solov2.fpn import Fpn
from services.segmenter.solov2.head import HeadOutput, SoloV2Head
from services.segmenter.solov2.variants import Variant


class SoloV2(nn.Module):
    """From images to per-cell categories, kernels and the mask features they work on."""

    def __init__(self, variant: Variant, categories: int) -> None:
        super().__init__()
        self.variant = variant
        self.backbone = BACKBONES[variant.backbone]()
        self.neck = Fpn(self.backbone.out_channels, variant.pyramid_channels)
        self.mask_head = SoloV2Head(variant, categories)

    def forward(self, images: Tensor) -> HeadOutput:
        """(N, 3, H, W), normalised as preprocessing.py does it; H and W multiples of 32."""
        return self.from_maps(self.backbone(images))

    def from_maps(self, maps: Sequence[Tensor]) -> HeadOutput:
        """What follows the backbone's four maps, finest first."""
        output: HeadOutput = self.mask_head(self.neck(maps))
        return output
