# SPDX-License-Identifier: Apache-2.0
import pytest
import torch

from services.segmenter.mask_rcnn.network import DetectionOptions, MaskRcnn, pasted
from services.segmenter.mask_rcnn.proposals import RegionProposals
from services.segmenter.runtimes.torch_dense import TorchOptions, autocast
from services.segmenter.runtimes.way import Precision

CATEGORIES = 3


def test_parameters_have_the_names_of_public_checkpoints() -> None:
    with torch.device("meta"):
        shapes = {name: tuple(value.shape) for name, value in MaskRcnn(50, 80).state_dict().items()}
    assert shapes["rpn_head.rpn_conv.weight"] == (256, 256, 3, 3)
    assert shapes["rpn_head.rpn_cls.weight"] == (3, 256, 1, 1)
    assert shapes["rpn_head.rpn_reg.bias"] == (12,)
    assert shapes["roi_head.bbox_head.shared_fcs.0.weight"] == (1024, 12544)
    assert shapes["roi_head.bbox_head.fc_cls.weight"] == (81, 1024)
    assert shapes["roi_head.bbox_head.fc_reg.weight"] == (320, 1024)
    assert shapes["roi_head.mask_head.convs.3.conv.weight"] == (256, 256, 3, 3)
    assert shapes["roi_head.mask_head.upsample.weight"] == (256, 256, 2, 2)
    assert shapes["roi_head.mask_head.conv_logits.weight"] == (80, 256, 1, 1)


def test_a_sure_anchor_becomes_a_proposal() -> None:
    head = RegionProposals(8)
    for layer in (head.rpn_conv, head.rpn_cls, head.rpn_reg):
        torch.nn.init.zeros_(layer.weight)
        torch.nn.init.zeros_(layer.bias)
    torch.nn.init.eye_(head.rpn_conv.weight[:, :, 1, 1])
    with torch.no_grad():
        head.rpn_cls.weight[1, 0] = 5.0  # the square anchor
    levels = [torch.zeros(1, 8, 128 // stride, 192 // stride) for stride in (4, 8, 16, 32, 64)]
    levels[1][0, 0, 6, 9] = 1.0
    with torch.inference_mode():
        boxes = head(levels, (128, 192))
    # of stride 8: 64 px a side around (72, 48)
    assert boxes[0].tolist() == [40, 16, 104, 80]
    assert len(boxes) <= 1000


def test_masks_are_stretched_over_their_boxes() -> None:
    soft = torch.zeros(2, 28, 28)
    soft[0, :, 14:] = 1.0
    soft[1] = 1.0
    masks = pasted(soft, torch.tensor([[10.0, 20.0, 50.0, 40.0], [0.0, 0.0, 8.0, 8.0]]), (60, 80)) > 0.5
    expected = torch.zeros(60, 80, dtype=torch.bool)
    expected[20:40, 30:50] = True
    assert torch.equal(masks[0], expected)
    assert int(masks[1].sum()) == 64
    assert pasted(torch.zeros(0, 28, 28), torch.zeros(0, 4), (60, 80)).shape == (0, 60, 80)


@pytest.mark.parametrize("precision", ["fp32", "bf16"])
def test_an_image_gives_instances_in_its_own_size(precision: Precision) -> None:
    torch.manual_seed(0)
    network = MaskRcnn(18, CATEGORIES).eval()
    with torch.inference_mode(), autocast(TorchOptions(torch.device("cpu"), precision)):
        found = network(torch.randn(1, 3, 64, 96), (60, 96), (120, 192), DetectionOptions(min_score=0.2))
    assert found.masks.shape == (len(found.labels), 120, 192)
    assert len(found.labels) > 0
    assert found.scores.tolist() == sorted(found.scores.tolist(), reverse=True)
    assert set(found.labels.tolist()) <= set(range(CATEGORIES))
