# SPDX-License-Identifier: Apache-2.0
from collections import Counter

import numpy as np

from services.segmenter.training.sample_order import SampleOrder

WIDE, NARROW, WIDE_TOO = (416, 128), (288, 224), (640, 192)
ASPECTS = np.array([3.3] * 9 + [1.33] * 5 + [3.1] * 2)


def _epoch(order: SampleOrder, epoch: int, batches: int) -> list[tuple[list[int], tuple[int, int]]]:
    return [order.batch(step) for step in range(epoch * batches, (epoch + 1) * batches)]


def test_an_epoch_has_every_sample_in_a_size_like_its_own() -> None:
    order = SampleOrder(ASPECTS, (WIDE, NARROW, WIDE_TOO), 4, seed=0)
    epoch = _epoch(order, 0, 5)
    counts = Counter(number for numbers, _ in epoch for number in numbers)
    assert counts.keys() == set(range(16))
    assert max(counts.values()) == 2  # five fill two batches of four
    for numbers, size in epoch:
        assert {number in range(9, 14) for number in numbers} == {size == NARROW}


def test_sizes_of_one_aspect_take_turns_by_chance() -> None:
    order = SampleOrder(ASPECTS, (WIDE, NARROW, WIDE_TOO), 4, seed=0)
    sizes = Counter(order.batch(step)[1] for step in range(100))
    assert sizes.keys() == {WIDE, NARROW, WIDE_TOO}


def test_epochs_differ_and_a_step_is_the_same_again_in_any_process() -> None:
    order = SampleOrder(ASPECTS, (WIDE, NARROW), 4, seed=0)
    first, second = _epoch(order, 0, 5), _epoch(order, 1, 5)
    assert first != second
    again = SampleOrder(ASPECTS, (WIDE, NARROW), 4, seed=0)
    assert [again.batch(step) for step in reversed(range(10))] == [*reversed(first + second)]
    assert _epoch(SampleOrder(ASPECTS, (WIDE, NARROW), 4, seed=1), 0, 5) != first


def test_fewer_samples_than_a_batch_fill_one() -> None:
    numbers, size = SampleOrder(np.array([1.0, 1.1]), (WIDE,), 5, seed=0).batch(3)
    assert len(numbers) == 5
    assert set(numbers) == {0, 1}
    assert size == WIDE
