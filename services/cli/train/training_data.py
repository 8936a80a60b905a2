# SPDX-License-Identifier: Apache-2.0
"""What a user names as data to learn from, or to be judged by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from services.runtime.errors import InputError
from services.simulator.data_sets.layout import COCO

if TYPE_CHECKING:
    from services.segmenter.training.coco_samples import JoinedSamples


@dataclass(frozen=True)
class TrainingData:
    """A file of annotations, and the folder that its images' names are relative to."""

    annotations: Path
    images: Path


def parse_training_data(text: str) -> TrainingData:
    """A folder of `kinemap simulate`, `FILE.json` (images beside it) or `FILE.json=IMAGES`.

    Raises:
        InputError: nothing is there; says what was expected.
    """
    named, _, images = text.partition("=")
    path = Path(named)
    if path.is_dir() and (path / COCO).is_file():
        return TrainingData(path / COCO, path)
    if path.is_file() and path.suffix == ".json":
        folder = Path(images) if images else path.parent
        if not folder.is_dir():
            raise InputError(f"{text}: no folder {folder}, expected that of the images")
        return TrainingData(path, folder)
    raise InputError(f"{text}: expected a folder of `kinemap simulate --formats coco`, FILE.json or FILE.json=IMAGES")


def read_samples(data: Sequence[TrainingData], categories: Sequence[str]) -> JoinedSamples:
    """All of it, one after the other. Raises InputError as CocoSamples."""
    from services.segmenter.training.coco_samples import CocoSamples, JoinedSamples

    return JoinedSamples([CocoSamples(item.annotations, item.images, categories) for item in data])
