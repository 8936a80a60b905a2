# SPDX-License-Identifier: Apache-2.0
"""Batches of augmented samples with their targets, made beside the training."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
import torch
from numpy.random import Generator
from torch import Tensor
from torch.utils.data import DataLoader, Dataset, Sampler

from services.segmenter.solov2.preprocessing import normalized
from services.segmenter.solov2.variants import Variant
from services.segmenter.training.copy_paste import CopyPaste
from services.segmenter.training.geometric_augmentation import Mirror, RandomScale
from services.segmenter.training.losses import BatchTargets
from services.segmenter.training.photometric_augmentation import Photometric
from services.segmenter.training.sample import Sample, Samples
from services.segmenter.training.sample_order import SampleOrder
from services.segmenter.training.targets import Targets, assign


class Batch(NamedTuple):
    """Images (N, 3, H, W) as the network takes them, and what it shall answer."""

    images: Tensor
    targets: BatchTargets

    def to(self, device: torch.device) -> "Batch":
        """The batch on a device."""
        moved = (
            tuple(part.to(device, non_blocking=True) for part in parts)
            for parts in (self.targets.categories, self.targets.instances, self.targets.masks)
        )
        return Batch(self.images.to(device, non_blocking=True), BatchTargets(*moved))


class Augmentation(Protocol):
    """What is done to a sample before it is learned from."""

    def apply(self, sample: Sample, draw: Callable[[], Sample], size: tuple[int, int], random: Generator) -> Sample:
        """The sample in `size` (width, height); `draw` gives another one to take instances of."""


@dataclass(frozen=True)
class Augmentations:
    """All that makes one sample many."""

    copy_paste: CopyPaste = field(default_factory=CopyPaste)
    mirror: Mirror = field(default_factory=Mirror)
    photometric: Photometric = field(default_factory=Photometric)

    def apply(self, sample: Sample, draw: Callable[[], Sample], size: tuple[int, int], random: Generator) -> Sample:
        """The sample in `size`, with instances of another one."""
        scale = RandomScale(size)
        sample = scale(self.mirror(sample, random), random)
        sample = self.copy_paste.paste(sample, lambda: scale(draw(), random), random)
        return self.photometric(sample, random)


class Draw(NamedTuple):
    """One place in a batch: numbers, so that the same draw gives the same bytes in any worker process."""

    step: int
    place: int


class _AugmentedSamples(Dataset[tuple[Tensor, Targets]]):
    def __init__(self, samples: Samples, augmentation: Augmentation, variant: Variant, options: "BatchOptions") -> None:
        self._samples = samples
        self._augmentation = augmentation
        self._variant = variant
        self._seed = options.seed
        aspects = np.array([samples.aspect(number) for number in range(len(samples))])
        self._order = SampleOrder(aspects, options.sizes, options.batch, options.seed)

    def __getitem__(self, draw: Draw) -> tuple[Tensor, Targets]:
        numbers, size = self._order.batch(draw.step)
        random = np.random.default_rng((self._seed, draw.step, draw.place))
        sample = self._samples[numbers[draw.place]]
        other = int(random.integers(len(self._samples)))
        sample = self._augmentation.apply(sample, lambda: self._samples[other], size, random)
        return torch.from_numpy(normalized(sample.image)), assign(sample, self._variant)


class _Draws(Sampler[list[Draw]]):
    """Those of each batch, from a step on."""

    def __init__(self, first_step: int, last_step: int, batch: int) -> None:
        self._steps = range(first_step, last_step)
        self._batch = batch

    def __len__(self) -> int:
        return len(self._steps)

    def __iter__(self):  # type: ignore[no-untyped-def]
        for step in self._steps:
            yield [Draw(step, place) for place in range(self._batch)]


def _collate(items: Sequence[tuple[Tensor, Targets]]) -> Batch:
    images = torch.stack([image for image, _ in items])
    targets = [target for _, target in items]
    categories = tuple(
        torch.from_numpy(np.stack(grids)) for grids in zip(*(t.categories for t in targets), strict=True)
    )
    instances = tuple(torch.from_numpy(np.stack(grids)) for grids in zip(*(t.instances for t in targets), strict=True))
    return Batch(images, BatchTargets(categories, instances, tuple(torch.from_numpy(t.masks) for t in targets)))


@dataclass(frozen=True)
class BatchOptions:
    """`steps` (first, last): batches of these steps; the same step has the same batch, also after a resumption."""

    batch: int
    steps: tuple[int, int]
    sizes: Sequence[tuple[int, int]]
    """(width, height) in multiples of 32; each batch has one of those that are most like its images"""
    seed: int = 0
    workers: int = 0


def batches(
    samples: Samples, augmentation: Augmentation, variant: Variant, options: BatchOptions
) -> "DataLoader[Batch]":
    """The batches, in order."""
    return DataLoader(
        _AugmentedSamples(samples, augmentation, variant, options),  # type: ignore[arg-type]
        batch_sampler=_Draws(*options.steps, options.batch),
        collate_fn=_collate,
        num_workers=options.workers,
        pin_memory=torch.cuda.is_available(),
    )
