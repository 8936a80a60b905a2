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
from services.segmenter.training.geometric_augmentation import Mirror, RandomSection
from services.segmenter.training.losses import BatchTargets
from services.segmenter.training.photometric_augmentation import Photometric
from services.segmenter.training.sample import Sample, Samples
from services.segmenter.training.targets import Targets, assign, grids_of


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
    """All that makes one sample many. `box` (width, height): what images are fitted into in use."""

    box: tuple[int, int]
    copy_paste: CopyPaste = field(default_factory=CopyPaste)
    mirror: Mirror = field(default_factory=Mirror)
    photometric: Photometric = field(default_factory=Photometric)

    def apply(self, sample: Sample, draw: Callable[[], Sample], size: tuple[int, int], random: Generator) -> Sample:
        """A section, with instances of a section of another sample."""
        section = RandomSection(size, self.box)
        sample = section(self.mirror(sample, random), random)
        sample = self.copy_paste.paste(sample, lambda: section(draw(), random), random)
        return self.photometric(sample, random)


class Draw(NamedTuple):
    """One place in a batch: numbers, so that the same draw gives the same bytes in any worker process."""

    step: int
    number: int


class _AugmentedSamples(Dataset[tuple[Tensor, Targets]]):
    def __init__(self, samples: Samples, augmentation: Augmentation, variant: Variant, options: "BatchOptions") -> None:
        self._samples = samples
        self._augmentation = augmentation
        self._variant = variant
        self._sizes = options.sizes
        self._seed = options.seed
        # kept, since of a large data set it takes milliseconds to draw; plain, so that workers can be sent it
        self._epoch, self._order = -1, np.zeros(0, np.int64)

    def _number_of(self, draw: int) -> int:
        """Every epoch in another order, each sample once in it."""
        epoch, place = divmod(draw, len(self._samples))
        if epoch != self._epoch:
            self._epoch = epoch
            self._order = np.random.default_rng((self._seed, epoch, 0)).permutation(len(self._samples))
        return int(self._order[place])

    def __getitem__(self, draw: Draw) -> tuple[Tensor, Targets]:
        # a batch has one size
        size = self._sizes[int(np.random.default_rng((self._seed, draw.step, 1)).integers(len(self._sizes)))]
        random = np.random.default_rng((self._seed, draw.number))
        sample = self._samples[self._number_of(draw.number)]
        other = int(random.integers(len(self._samples)))
        sample = self._augmentation.apply(sample, lambda: self._samples[other], size, random)
        targets = assign(sample, self._variant, grids_of(size[0], self._variant))
        return torch.from_numpy(normalized(sample.image)), targets


class _Draws(Sampler[list[Draw]]):
    """Those of each batch, from a step on."""

    def __init__(self, first_step: int, last_step: int, batch: int) -> None:
        self._steps = range(first_step, last_step)
        self._batch = batch

    def __len__(self) -> int:
        return len(self._steps)

    def __iter__(self):  # type: ignore[no-untyped-def]
        for step in self._steps:
            yield [Draw(step, number) for number in range(step * self._batch, (step + 1) * self._batch)]


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
    """(width, height) in multiples of 32; each batch has one of them"""
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
