# SPDX-License-Identifier: Apache-2.0
import pytest
import torch

from services.segmenter.solov2.backbones import BACKBONES, early_part


@pytest.mark.parametrize("name", BACKBONES)
def test_maps_have_the_strides_and_channels_it_says(name: str) -> None:
    backbone = BACKBONES[name]().eval()
    with torch.inference_mode():
        maps = backbone(torch.zeros(1, 3, 64, 96))
    assert tuple(features.shape[1] for features in maps) == backbone.out_channels
    assert [tuple(features.shape[2:]) for features in maps] == [(16, 24), (8, 12), (4, 6), (2, 3)]


@pytest.mark.parametrize("name", BACKBONES)
def test_the_early_part_is_all_that_the_finest_map_depends_on(name: str) -> None:
    backbone = BACKBONES[name]()
    backbone(torch.randn(2, 3, 64, 96))[0].square().sum().backward()
    reached = {value for value in backbone.parameters() if value.grad is not None}
    assert reached == {value for part in early_part(backbone) for value in part.parameters()}


def test_efficientnet_lite0_has_as_many_weights_as_published_without_its_classifier() -> None:
    # 4,652,008 in all (Google's tpu repository); 1280 x 320 + 2 x 1280 and 1281 x 1000 classify
    weights = sum(value.numel() for value in BACKBONES["efficientnet-lite0"]().parameters())
    assert weights == 4_652_008 - (1280 * 320 + 2 * 1280) - 1281 * 1000
