# SPDX-License-Identifier: Apache-2.0
"""Agreement with mmdetection 3.3 on SOLOv2-Light R18, layer by layer and in the final instances."""

import json
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch
from torch import Tensor
from torch.nn.functional import max_pool2d

from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.instances import instances_of
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.points_nms import points_nms
from services.segmenter.solov2.preprocessing import NetworkInput, prepare
from services.segmenter.solov2.variants import VARIANTS
from tests.unit.segmenter.solov2.reproducible_weights import drawn_weights

TOLERANCE = {"atol": 2e-3, "rtol": 2e-3}  # the reference is stored in 16 bits


@dataclass(frozen=True)
class Reference:
    """What was computed there, and what we compute of the same image and weights."""

    arrays: dict[str, np.ndarray]
    width: int
    given: NetworkInput
    levels: tuple[Tensor, ...]
    output: HeadOutput


@pytest.fixture(scope="module")
def reference(golden_outputs: Path) -> Reference:
    folder = golden_outputs / "solov2_light_r18"
    variant = VARIANTS["solov2-light_r18"]
    network = SoloV2(variant, 80).eval()
    network.load_state_dict(drawn_weights(json.loads((folder / "keys.json").read_text())))
    image = cv2.imread(str(folder / "image.png"))
    given = prepare(np.asarray(image, np.uint8), variant.test_size)
    with torch.inference_mode():
        levels = network.neck(network.backbone(torch.from_numpy(given.pixels)))
        output = network.mask_head(levels)
    return Reference(dict(np.load(folder / "golden.npz")), image.shape[1], given, levels, output)


def test_the_image_is_resized_and_padded_alike(reference: Reference) -> None:
    assert reference.given.resized_hw == tuple(reference.arrays["resized_hw"])
    assert reference.given.pixels.shape[2:] == tuple(reference.arrays["padded_hw"])


@pytest.mark.parametrize("level", range(5))
def test_pyramid_and_head_agree(reference: Reference, level: int) -> None:
    means = reference.levels[level].mean((2, 3))
    np.testing.assert_allclose(means, reference.arrays[f"fpn{level}_mean"], atol=1e-4, rtol=1e-4)
    np.testing.assert_allclose(reference.output.kernels[level], reference.arrays[f"kernel{level}"], **TOLERANCE)
    scores = reference.output.categories[level].sigmoid()
    kept = points_nms(scores).permute(0, 2, 3, 1).numpy()
    differs = ~np.isclose(kept, reference.arrays[f"cls{level}"], **TOLERANCE)
    # of two neighbours that are equally sure, the last bit of a sum decides, and with it the number of threads
    largest = max_pool2d(scores, 2, stride=1, padding=1)[:, :, :-1, :-1].permute(0, 2, 3, 1).numpy()
    around = max_pool2d(scores, 3, stride=1, padding=1).permute(0, 2, 3, 1).numpy()
    raw = scores.permute(0, 2, 3, 1).numpy()
    assert differs.sum() <= 4
    assert (np.minimum(abs(largest - raw), abs(around - raw))[differs] < 1e-5).all()


def test_mask_features_agree(reference: Reference) -> None:
    ours = reference.output.mask_features[:, :, ::4, ::4]
    np.testing.assert_allclose(ours, reference.arrays["mask_feat_sub"], **TOLERANCE)


def test_the_same_instances(reference: Reference) -> None:
    found = instances_of(reference.output, reference.given.resized_hw, reference.given.original_hw)
    np.testing.assert_array_equal(found.labels, reference.arrays["labels"])
    np.testing.assert_allclose(found.scores, reference.arrays["scores"], **TOLERANCE)
    expected = np.unpackbits(reference.arrays["masks"], axis=-1)[..., : reference.width].astype(bool)
    for ours, theirs in zip(found.masks.numpy(), expected, strict=True):
        assert (ours & theirs).sum() >= 0.99 * (ours | theirs).sum()
