# SPDX-License-Identifier: Apache-2.0
"""Trains a vocabulary on the features that the engine takes of images."""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError
from services.slam import _engine


def train_vocabulary(
    images: Iterable[npt.NDArray[np.uint8]], *, branching: int, depth: int, features: int = 2000, seed: int = 0
) -> _engine.Vocabulary:
    """The vocabulary of grey images (H, W). The same images and numbers give the same bytes.

    Raises:
        InputError: a number out of its range, or images that show next to nothing.
    """
    options = _engine.EngineOptions()
    options.features = features
    descriptors = [_engine.descriptors_of(np.ascontiguousarray(image), options)[0] for image in images]
    image_of_descriptor = np.repeat(np.arange(len(descriptors), dtype=np.int32), [len(rows) for rows in descriptors])
    every = np.concatenate(descriptors) if descriptors else np.empty((0, 32), np.uint8)
    try:
        return _engine.Vocabulary.train(every, image_of_descriptor, branching, depth, seed)
    except ValueError as error:
        raise InputError(f"training: {error}") from error
