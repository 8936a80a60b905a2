# SPDX-License-Identifier: Apache-2.0
"""Batches of augmented samples with their targets, made beside the training."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader, Dataset, Sampler

from services.segmenter.solov2.preprocessing import normalized
from services.segmenter.solov2.variants import Variant
from services.segmenter.training.copy_paste import CopyPaste
from services.segmenter.training.geometric_augmentation import Mirror, RandomSection
from services.segmenter.training.losses import BatchTargets
from services.segmenter.training.photometric_augmentation import Photometric
from services.segmenter.training.sample import Sample, Samples
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


@dataclass(frozen=True)
class Augmentations:
    """All that is done to a sample; `size` (width, height) in multiples of 32 is what comes out."""

    size: tuple[int, int]
    copy_paste: CopyPaste = field(default_factory=CopyPaste)
    mirror: Mirror = field(default_factory=Mirror)
    photometric: Photometric = field(default_factory=Photometric)

    def apply(self, sample: Sample, other: Sample, random: np.random.Generator) -> Sample:
        """`sample`, with instances of `other`; both are looked at in a section of their own."""
        section = RandomSection(self.size)
        sample = section(self.mirror(sample, random), random)
        sample = self.copy_paste.paste(sample, section(other, random), random)
        return self.photometric(sample, random)


class _AugmentedSamples(Dataset[tuple[Tensor, Targets]]):
    """Draws (step, sample) are numbers: the same draw gives the same bytes in any worker process."""

    def __init__(self, samples: Samples, augmentations: Augmentations, variant: Variant, seed: int) -> None:
        self._samples = samples
        self._augmentations = augmentations
        self._variant = variant
        self._seed = seed
        # kept, since of a large data set it takes milliseconds to draw; plain, so that workers can be sent it
        self._epoch, self._order = -1, np.zeros(0, np.int64)

    def _number_of(self, draw: int) -> int:
        """Every epoch in another order, each sample once in it."""
        epoch, place = divmod(draw, len(self._samples))
        if epoch != self._epoch:
            self._epoch = epoch
            self._order = np.random.default_rng((self._seed, epoch, 0)).permutation(len(self._samples))
        return int(self._order[place])

    def __getitem__(self, draw: int) -> tuple[Tensor, Targets]:
        random = np.random.default_rng((self._seed, draw))
        sample = self._samples[self._number_of(draw)]
        other = self._samples[int(random.integers(len(self._samples)))]
        sample = self._augmentations.apply(sample, other, random)
        return torch.from_numpy(normalized(sample.image)), assign(sample, self._variant)


class _Draws(Sampler[list[int]]):
    """The numbers of each batch, from a step on."""

    def __init__(self, first_step: int, last_step: int, batch: int) -> None:
        self._steps = range(first_step, last_step)
        self._batch = batch

    def __len__(self) -> int:
        return len(self._steps)

    def __iter__(self):  # type: ignore[no-untyped-def]
        for step in self._steps:
            yield list(range(step * self._batch, (step + 1) * self._batch))


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
    seed: int = 0
    workers: int = 0


def batches(
    samples: Samples, augmentations: Augmentations, variant: Variant, options: BatchOptions
) -> "DataLoader[Batch]":
    """The batches, in order."""
    return DataLoader(
        _AugmentedSamples(samples, augmentations, variant, options.seed),  # type: ignore[arg-type]
        batch_sampler=_Draws(*options.steps, options.batch),
        collate_fn=_collate,
        num_workers=options.workers,
        pin_memory=torch.cuda.is_available(),
    )
