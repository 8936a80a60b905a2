# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from services.segmenter.training.batches import Augmentations
from services.segmenter.training.copy_paste import CopyPaste
from services.segmenter.training.geometric_augmentation import Mirror, RandomScale, resized
from services.segmenter.training.photometric_augmentation import Photometric
from services.segmenter.training.sample import Sample
from tests.unit.segmenter.training.painted_samples import BLUE, RED, painted_sample


def _agreement(sample: Sample) -> float:
    """Share of the masks' pixels that have the colour of their label."""
    right = total = 0
    for mask, label in zip(sample.masks, sample.labels, strict=True):
        distance = np.abs(sample.image[mask > 0].astype(int) - (BLUE, RED)[label]).max(axis=1)
        right, total = right + int((distance < 30).sum()), total + len(distance)
    return right / total


@pytest.mark.parametrize("seed", range(8))
def test_masks_move_with_the_image(seed: int) -> None:
    random = np.random.default_rng(seed)
    sample = RandomScale((128, 96))(Mirror()(painted_sample(seed), random), random)
    assert sample.image.shape == (96, 128, 3)
    assert sample.masks.shape[1:] == (96, 128)
    assert len(sample.masks) == len(sample.labels)
    if len(sample.labels):
        assert _agreement(sample) > 0.9


@pytest.mark.parametrize("seed", range(8))
def test_what_is_pasted_covers_what_was_there(seed: int) -> None:
    random = np.random.default_rng(seed)
    before, other = painted_sample(seed), painted_sample(seed + 100, (200, 100))
    after = CopyPaste(share=1.0).paste(before, lambda: other, random)
    assert after.masks.sum(0).max() == 1
    assert _agreement(after) > 0.9
    assert len(after.labels) >= 1
    np.testing.assert_array_equal(before.masks, painted_sample(seed).masks)


def test_colours_change_and_masks_do_not() -> None:
    sample = painted_sample(1)
    images = [Photometric()(sample, np.random.default_rng(seed)) for seed in range(30)]
    assert all(changed.masks is sample.masks for changed in images)
    differences = [np.abs(changed.image.astype(int) - sample.image).mean() for changed in images]
    assert np.median(differences) > 10
    assert all(changed.image.dtype == np.uint8 for changed in images)


def test_the_same_chance_gives_the_same_bytes() -> None:
    one, two = (
        Augmentations().apply(painted_sample(3), lambda: painted_sample(4), (128, 96), np.random.default_rng(9))
        for _ in range(2)
    )
    assert one.image.shape == (96, 128, 3)
    np.testing.assert_array_equal(one.image, two.image)
    np.testing.assert_array_equal(one.masks, two.masks)


def test_most_cuts_show_an_instance() -> None:
    random = np.random.default_rng(1)
    image = np.full((400, 800, 3), 90, np.uint8)
    mask = np.zeros((1, 400, 800), np.uint8)
    mask[0, 300:330, 700:740] = 1
    sample = Sample(image, mask, np.zeros(1, np.int64))
    scale = RandomScale((160, 96), scales=(4.5, 5.5))
    shown = [len(scale(sample, random).labels) for _ in range(200)]
    assert 0.65 < np.mean(shown) < 0.9


def test_an_image_that_just_fits_is_shown_whole() -> None:
    sample = painted_sample(2, (200, 120))
    shown = RandomScale((100, 96), scales=(1.0, 1.0), aspect=0.0)(sample, np.random.default_rng(0))
    assert shown.image.shape == (96, 100, 3)
    assert not shown.image[60:].any()
    np.testing.assert_array_equal(shown.image[:60], resized(sample, 100, 60).image)
