# SPDX-License-Identifier: Apache-2.0
"""Labels become object ids."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hypothesis_numpy

from services.tracker.track_image import draw_track_image

SMALL = st.integers(0, 6)


@given(hypothesis_numpy.arrays(np.uint32, (5, 7), elements=SMALL), st.dictionaries(st.integers(1, 6), st.integers(1)))
def test_every_pixel_is_its_instances_object(labels: np.ndarray, object_of: dict[int, int]) -> None:
    object_of = {instance: min(given, 2**32 - 1) for instance, given in object_of.items()}
    image = draw_track_image(labels, object_of)
    assert image.dtype == np.uint32
    for label, pixel in zip(labels.ravel(), image.ravel(), strict=True):
        assert pixel == object_of.get(int(label), 0)


def test_large_instance_ids() -> None:
    labels = np.array([[0, 4_000_000_000], [17, 16]], np.uint32)
    np.testing.assert_array_equal(draw_track_image(labels, {4_000_000_000: 2, 17: 1}), [[0, 2], [1, 0]])
