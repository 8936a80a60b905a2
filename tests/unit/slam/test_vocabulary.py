# SPDX-License-Identifier: Apache-2.0
"""Training a vocabulary on images, and the one that is shipped."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from services.runtime.errors import InputError
from services.slam import _engine
from services.slam.engine_adapter import EngineSettings
from services.slam.vocabulary import SHIPPED_VOCABULARY
from services.slam.vocabulary.training import train_vocabulary

WIDTH, HEIGHT = 320, 160
MOST_BYTES = 4_000_000


def image(seed: int) -> npt.NDArray[np.uint8]:
    """Blocks of random greys: corners everywhere, no two images alike."""
    blocks = np.random.default_rng(seed).integers(0, 256, (HEIGHT // 8, WIDTH // 8), np.uint8)
    return np.kron(blocks, np.ones((8, 8), np.uint8))


def bag(vocabulary: _engine.Vocabulary, pixels: npt.NDArray[np.uint8]) -> _engine.BagOfWords:
    return vocabulary.describe(_engine.descriptors_of(pixels, _engine.EngineOptions())[0])


def trained(seed: int = 0) -> _engine.Vocabulary:
    return train_vocabulary(map(image, range(6)), branching=8, depth=4, features=500, seed=seed)


def test_the_same_images_and_seed_give_the_same_bytes(tmp_path: Path) -> None:
    for name, seed in (("one", 0), ("again", 0), ("other", 1)):
        trained(seed).save(str(tmp_path / name))
    assert (tmp_path / "one").read_bytes() == (tmp_path / "again").read_bytes()
    assert (tmp_path / "one").read_bytes() != (tmp_path / "other").read_bytes()


def test_a_shifted_view_is_more_similar_than_another_image() -> None:
    vocabulary = trained()
    seen = bag(vocabulary, image(2))
    again = bag(vocabulary, np.roll(image(2), 24, axis=1))
    assert sum(weight for _, weight in seen.words) == pytest.approx(1)
    assert seen.similarity(seen) == pytest.approx(1)
    assert seen.similarity(again) > 1.2 * max(seen.similarity(bag(vocabulary, image(other))) for other in (0, 1, 3, 7))


def test_what_cannot_be_trained_is_said() -> None:
    with pytest.raises(InputError, match="branching: expected 2 to 255, got 1"):
        train_vocabulary([image(0)], branching=1, depth=3)
    with pytest.raises(InputError, match="expected at least 10"):
        train_vocabulary([np.zeros((HEIGHT, WIDTH), np.uint8)], branching=10, depth=3)
    with pytest.raises(InputError, match="expected at least 10"):
        train_vocabulary([], branching=10, depth=3)


def test_the_shipped_vocabulary_is_small_and_fits_the_features() -> None:
    assert SHIPPED_VOCABULARY.stat().st_size < MOST_BYTES
    vocabulary = _engine.Vocabulary.load(EngineSettings().vocabulary_path)
    assert vocabulary.word_count > 1000
    seen = bag(vocabulary, image(2))
    again = bag(vocabulary, np.roll(image(2), 24, axis=1))
    assert seen.similarity(again) > 1.5 * seen.similarity(bag(vocabulary, image(3)))


def test_an_engine_names_the_vocabulary_it_cannot_read(tmp_path: Path) -> None:
    path = tmp_path / "cut.kmvocab"
    path.write_bytes(SHIPPED_VOCABULARY.read_bytes()[:1000])
    options = _engine.EngineOptions()
    options.vocabulary_path = str(path)
    camera = _engine.CameraModel(WIDTH, HEIGHT, WIDTH, WIDTH, WIDTH / 2, HEIGHT / 2)
    with pytest.raises(ValueError, match=r"cut\.kmvocab: cut off or damaged: expected \d+ bytes, got 1000"):
        _engine.Engine(camera, options)
