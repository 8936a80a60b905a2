# SPDX-License-Identifier: Apache-2.0
"""From the head's output to instances: dynamic convolution, then two rounds of suppression."""

from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import interpolate

from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.matrix_nms import matrix_nms
from services.segmenter.solov2.points_nms import points_nms
from services.segmenter.solov2.variants import STRIDES

_MASK_STRIDE = 4


@dataclass(frozen=True)
class InstanceOptions:
    """Which candidates become instances (mmdetection's test settings)."""

    min_category_score: float = 0.1
    least_area: float = 1.0
    """of a mask in elements of the mask features, by the stride of its level; what is smaller is left out"""
    mask_threshold: float = 0.5
    most_candidates: int = 500
    min_score: float = 0.05
    """after the suppression"""
    most_instances: int = 100


@dataclass(frozen=True)
class SegmentedInstances:
    """Instances of one image, surest first."""

    masks: Tensor
    """(M, H, W) bool, in the original image's size"""
    labels: Tensor
    """(M,) positions among the categories"""
    scores: Tensor
    """(M,) 0 to 1"""


def instances_of(
    output: HeadOutput,
    resized_hw: tuple[int, int],
    original_hw: tuple[int, int],
    options: InstanceOptions | None = None,
    image: int = 0,
) -> SegmentedInstances:
    """The instances of image number `image` of a batch.

    Args:
        output: of the network.
        resized_hw: the part of the network's input that shows the image.
        original_hw: the image's own size, which the masks get.
        options: thresholds.
        image: its place in the batch.
    """
    options = options or InstanceOptions()
    scores, labels, kernels, strides = _candidates(output, image, options)
    features = output.mask_features[image]
    # a kernel is a 1x1 convolution over the mask features
    soft = (kernels @ features.flatten(1)).view(-1, *features.shape[-2:]).sigmoid().float()
    hard = soft > options.mask_threshold
    areas = hard.sum((1, 2))
    large = areas > options.least_area * strides
    scores, labels, soft, hard, areas = scores[large], labels[large], soft[large], hard[large], areas[large]
    # an unsure mask makes an unsure instance
    scores = scores * (soft * hard).sum((1, 2)) / areas
    order = _surest_first(scores)[: options.most_candidates]
    scores, labels, soft, hard = scores[order], labels[order], soft[order], hard[order]
    if len(scores):
        scores = matrix_nms(hard, labels, scores)
    order = _surest_first(scores)
    order = order[scores[order] >= options.min_score][: options.most_instances]
    masks = _enlarged(soft[order], features.shape[-2:], resized_hw, original_hw) > options.mask_threshold
    return SegmentedInstances(masks, labels[order], scores[order])


def _surest_first(scores: Tensor) -> Tensor:
    return torch.sort(scores, descending=True, stable=True).indices


def _candidates(output: HeadOutput, image: int, options: InstanceOptions) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Of the cells that are sure enough of a category: score, category, kernel and stride (the smallest area)."""
    cell_scores, cell_kernels = [], []
    for categories, kernels in zip(output.categories, output.kernels, strict=True):
        scores = points_nms(categories[image : image + 1].sigmoid())[0]
        cell_scores.append(scores.flatten(1).T)
        cell_kernels.append(kernels[image].flatten(1).T)
    scores = torch.cat(cell_scores).float()
    counts = torch.tensor([len(level) for level in cell_scores], device=scores.device)
    strides = torch.tensor(STRIDES, device=scores.device).repeat_interleave(counts)
    cells, labels = (scores > options.min_category_score).nonzero(as_tuple=True)
    return scores[cells, labels], labels, torch.cat(cell_kernels)[cells], strides[cells]


def _enlarged(
    soft: Tensor, features_hw: torch.Size, resized_hw: tuple[int, int], original_hw: tuple[int, int]
) -> Tensor:
    """Masks (M, h, w) of the mask features' size in the original image's, without what was padded."""
    if len(soft) == 0:
        return soft.new_zeros((0, *original_hw))
    padded_hw = [size * _MASK_STRIDE for size in features_hw]
    padded = interpolate(soft[None], size=padded_hw, mode="bilinear", align_corners=False)
    shown = padded[:, :, : resized_hw[0], : resized_hw[1]]
    return interpolate(shown, size=original_hw, mode="bilinear", align_corners=False)[0]
