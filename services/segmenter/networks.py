# SPDX-License-Identifier: Apache-2.0
"""The networks that there are, by the name of their variant."""

from types import MappingProxyType
from typing import Final

from services.segmenter.mask_rcnn.network import MaskRcnn
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS

Network = SoloV2 | MaskRcnn

MASK_RCNN_DEPTHS: Final = MappingProxyType({"mask-rcnn_r50": 50, "mask-rcnn_r101": 101})
MASK_RCNN_BOX: Final = (1333, 800)
NAMES: Final = (*VARIANTS, *MASK_RCNN_DEPTHS)


def build(variant: str, categories: int) -> Network:
    """A network without weights. `variant` is one of NAMES."""
    if variant in VARIANTS:
        return SoloV2(VARIANTS[variant], categories)
    return MaskRcnn(MASK_RCNN_DEPTHS[variant], categories)


def input_box(variant: str) -> tuple[int, int]:
    """(width, height) that its public weights expect images to be fitted into."""
    return VARIANTS[variant].test_size if variant in VARIANTS else MASK_RCNN_BOX
