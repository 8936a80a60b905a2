# SPDX-License-Identifier: Apache-2.0
"""The whole network, and what it finds in one image."""

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn.functional import grid_sample

from services.segmenter.mask_rcnn.boxes import decode, suppressed
from services.segmenter.mask_rcnn.heads import RoiHead
from services.segmenter.mask_rcnn.proposals import RegionProposals
from services.segmenter.mask_rcnn.roi_align import roi_align
from services.segmenter.solov2.fpn import Fpn
from services.segmenter.solov2.instances import SegmentedInstances
from services.segmenter.solov2.resnet import ResNet

_CHANNELS = 256
_STDS = (0.1, 0.1, 0.2, 0.2)
_BOX_BINS, _MASK_BINS = 7, 14


@dataclass(frozen=True)
class DetectionOptions:
    """Which boxes become instances (mmdetection's test settings)."""

    min_score: float = 0.05
    most_iou: float = 0.5
    most_instances: int = 100
    mask_threshold: float = 0.5


class MaskRcnn(nn.Module):
    """ResNet, feature pyramid, proposals, heads."""

    def __init__(self, depth: int, categories: int) -> None:
        super().__init__()
        self.backbone = ResNet(depth)
        self.neck = Fpn(self.backbone.out_channels, _CHANNELS)
        self.rpn_head = RegionProposals(_CHANNELS)
        self.roi_head = RoiHead(_CHANNELS, categories)

    def forward(
        self, image: Tensor, resized_hw: tuple[int, int], original_hw: tuple[int, int], options: DetectionOptions
    ) -> SegmentedInstances:
        """The instances of one image (1, 3, H, W), of which `resized_hw` shows something; masks in `original_hw`."""
        levels = self.neck(self.backbone(image))
        proposals = self.rpn_head(levels, resized_hw)
        boxes, labels, scores = self._boxes(levels, proposals, resized_hw, options)
        logits = self.roi_head.mask_head(roi_align(levels[:4], boxes, _MASK_BINS))
        soft = logits[torch.arange(len(labels), device=labels.device), labels].float().sigmoid()
        scale = boxes.new_tensor([original_hw[1] / resized_hw[1], original_hw[0] / resized_hw[0]] * 2)
        masks = pasted(soft, boxes * scale, original_hw) > options.mask_threshold
        return SegmentedInstances(masks, labels, scores)

    def _boxes(
        self, levels: tuple[Tensor, ...], proposals: Tensor, resized_hw: tuple[int, int], options: DetectionOptions
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Boxes (N, 4), categories and scores, surest first."""
        logits, deltas = self.roi_head.bbox_head(roi_align(levels[:4], proposals, _BOX_BINS))
        sure = logits.float().softmax(1)[:, :-1]
        places, labels = (sure > options.min_score).nonzero(as_tuple=True)
        boxes = decode(proposals[places], deltas[places, labels].float(), _STDS, resized_hw)
        scores = sure[places, labels]
        kept = suppressed(boxes, scores, labels, options.most_iou)[: options.most_instances]
        return boxes[kept], labels[kept], scores[kept]


def pasted(soft: Tensor, boxes: Tensor, image_hw: tuple[int, int]) -> Tensor:
    """Masks (N, h, w) stretched over their boxes (N, 4) in an image: (N, H, W), 0 outside."""
    height, width = image_hw
    if len(soft) == 0:
        return soft.new_zeros((0, height, width))
    x = (torch.arange(width, device=soft.device) + 0.5)[None]
    y = (torch.arange(height, device=soft.device) + 0.5)[None]
    x = 2 * (x - boxes[:, :1]) / (boxes[:, 2:3] - boxes[:, :1]).clamp(min=1e-3) - 1
    y = 2 * (y - boxes[:, 1:2]) / (boxes[:, 3:] - boxes[:, 1:2]).clamp(min=1e-3) - 1
    grid = torch.stack([x[:, None, :].expand(-1, height, width), y[:, :, None].expand(-1, height, width)], dim=-1)
    return grid_sample(soft[:, None], grid, align_corners=False)[:, 0]
