# SPDX-License-Identifier: Apache-2.0
import torch

from services.segmenter.mask_rcnn.roi_align import roi_align


def _ramps(height: int, width: int) -> list[torch.Tensor]:
    """Levels whose two channels are x and y of their elements' centres, in image pixels."""
    levels = []
    for stride in (4, 8, 16, 32):
        y = (torch.arange(height // stride) + 0.5) * stride
        x = (torch.arange(width // stride) + 0.5) * stride
        levels.append(torch.stack(torch.meshgrid(x, y, indexing="xy"))[None])
    return levels


def test_bins_have_the_mean_of_what_they_cover() -> None:
    boxes = torch.tensor([[40.0, 60.0, 96.0, 130.0], [100.0, 80.0, 420.0, 360.0]])
    aligned = roi_align(_ramps(512, 512), boxes, 7)
    assert aligned.shape == (2, 2, 7, 7)
    for box, features in zip(boxes, aligned, strict=True):
        centers = (torch.arange(7) + 0.5) / 7
        assert torch.allclose(features[0, 0], box[0] + centers * (box[2] - box[0]), atol=1e-3)
        assert torch.allclose(features[1, :, 0], box[1] + centers * (box[3] - box[1]), atol=1e-3)


def test_large_boxes_are_looked_up_in_coarse_levels() -> None:
    levels = [torch.full((1, 1, 512 // stride, 512 // stride), float(stride)) for stride in (4, 8, 16, 32)]
    sizes = (20.0, 111.0, 113.0, 225.0, 450.0)
    boxes = torch.tensor([[10.0, 10.0, 10.0 + size, 10.0 + size] for size in sizes])
    assert roi_align(levels, boxes, 7)[:, 0, 3, 3].tolist() == [4, 4, 8, 16, 32]


def test_no_boxes() -> None:
    assert roi_align(_ramps(64, 64), torch.zeros(0, 4), 7).shape == (0, 2, 7, 7)
