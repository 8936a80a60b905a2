# SPDX-License-Identifier: Apache-2.0
import pytest
import torch

from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import GRIDS, VARIANTS


@pytest.mark.parametrize("name", VARIANTS)
def test_shapes_of_every_variant(name: str) -> None:
    variant = VARIANTS[name]
    with torch.inference_mode():
        output = SoloV2(variant, 7).eval()(torch.zeros(2, 3, 64, 96))
    assert [tuple(kernel.shape) for kernel in output.kernels] == [(2, variant.mask_channels, s, s) for s in GRIDS]
    assert [tuple(scores.shape) for scores in output.categories] == [(2, 7, s, s) for s in GRIDS]
    assert output.mask_features.shape == (2, variant.mask_channels, 16, 24)


def test_parameters_have_the_names_of_public_checkpoints() -> None:
    shapes = {name: tuple(value.shape) for name, value in SoloV2(VARIANTS["solov2_r50"], 80).state_dict().items()}
    assert shapes["backbone.layer1.0.downsample.0.weight"] == (256, 64, 1, 1)
    assert shapes["backbone.layer3.5.conv2.weight"] == (256, 256, 3, 3)
    assert shapes["neck.lateral_convs.3.conv.bias"] == (256,)
    assert shapes["mask_head.kernel_convs.0.conv.weight"] == (512, 258, 3, 3)
    assert shapes["mask_head.cls_convs.3.gn.weight"] == (512,)
    assert shapes["mask_head.conv_kernel.weight"] == (256, 512, 3, 3)
    assert shapes["mask_head.mask_feature_head.convs_all_levels.3.conv0.conv.weight"] == (128, 258, 3, 3)
    assert shapes["mask_head.mask_feature_head.conv_pred.conv.weight"] == (256, 128, 1, 1)
