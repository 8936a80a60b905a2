# SPDX-License-Identifier: Apache-2.0
"""Focal loss of the categories and Dice loss of the masks."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from services.segmenter.solov2.head import HeadOutput
from services.segmenter.training.targets import NOBODY

_ALPHA, _GAMMA = 0.25, 2.0
_MASK_WEIGHT = 3.0


def focal_loss(logits: Tensor, targets: Tensor) -> Tensor:
    """-alpha_t (1 - p_t)^gamma log p_t, summed (Lin et al., ICCV 2017; thesis equation 3.8).

    Args:
        logits: any shape.
        targets: the same shape, 0 or 1.
    """
    cross_entropy = binary_cross_entropy_with_logits(logits, targets, reduction="none")
    alpha_t = _ALPHA * targets + (1 - _ALPHA) * (1 - targets)
    return (alpha_t * (1 - torch.exp(-cross_entropy)) ** _GAMMA * cross_entropy).sum()


def dice_loss(predicted: Tensor, targets: Tensor) -> Tensor:
    """1 - (2 sum y g + 1) / (sum y^2 + sum g^2 + 1) of each row (Milletari et al., 3DV 2016; thesis equation 3.5).

    Args:
        predicted: (P, pixels) in 0..1.
        targets: (P, pixels) in 0..1; the loss is least where both are equal, also between 0 and 1.
    """
    overlap = (predicted * targets).sum(1)
    return 1 - (2 * overlap + 1) / (predicted.square().sum(1) + targets.square().sum(1) + 1)


@dataclass(frozen=True)
class BatchTargets:
    """Targets of N images, on the network's device."""

    categories: tuple[Tensor, ...]
    """(N, S, S) a grid: category or NOBODY"""
    instances: tuple[Tensor, ...]
    """(N, S, S) a grid: row of the image's masks or NOBODY"""
    masks: tuple[Tensor, ...]
    """(M, H / 4, W / 4) an image"""


@dataclass(frozen=True)
class Loss:
    """Both parts, as they are added up."""

    category: Tensor
    mask: Tensor
    answering_cells: int

    @property
    def total(self) -> Tensor:
        """What is minimised."""
        return self.category + self.mask


def segmentation_loss(output: HeadOutput, targets: BatchTargets) -> Loss:
    """The mean over the cells that answer for an instance; 3 parts Dice to one of focal loss, as in the paper."""
    cells = sum(int((grid != NOBODY).sum()) for grid in targets.categories)
    category = output.mask_features.new_zeros((), dtype=torch.float32)
    for logits, wanted in zip(output.categories, targets.categories, strict=True):
        one_hot = _one_hot(wanted, logits.shape[1])
        category = category + focal_loss(logits.float(), one_hot)
    dice = [_mask_losses(output, targets, image) for image in range(len(targets.masks))]
    mask = torch.cat(dice).sum() / max(cells, 1)
    return Loss(category / (cells + 1), _MASK_WEIGHT * mask, cells)


def _one_hot(wanted: Tensor, categories: int) -> Tensor:
    """(N, S, S) to (N, categories, S, S); NOBODY is 0 everywhere."""
    every = torch.arange(categories, device=wanted.device).view(1, -1, 1, 1)
    return (wanted[:, None] == every).to(torch.float32)


def _mask_losses(output: HeadOutput, targets: BatchTargets, image: int) -> Tensor:
    """Dice loss of each cell of one image that answers."""
    kernels, rows = _answering(output.kernels, targets.instances, image)
    features = output.mask_features[image].flatten(1)
    predicted = (kernels @ features).float().sigmoid()
    return dice_loss(predicted, targets.masks[image].flatten(1)[rows])


def _answering(kernels: Sequence[Tensor], instances: Sequence[Tensor], image: int) -> tuple[Tensor, Tensor]:
    """Kernels (P, channels) of the cells that answer, and the row of the mask each shall give (P,)."""
    found, rows = [], []
    for kernel, grid in zip(kernels, instances, strict=True):
        answers = grid[image] != NOBODY
        found.append(kernel[image].permute(1, 2, 0)[answers])
        rows.append(grid[image][answers])
    return torch.cat(found), torch.cat(rows)
