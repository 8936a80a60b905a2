# SPDX-License-Identifier: Apache-2.0
"""Dense flow on images whose motion is known."""

import cv2
import numpy as np
import pytest

from services.motion.flow.dense_flow import DenseFlow
from services.motion.flow.options import OpticalFlowOptions
from services.runtime.errors import InputError


def textured(height: int = 160, width: int = 320) -> np.ndarray:
    noise = np.random.default_rng(5).integers(0, 256, (height, width)).astype(np.uint8)
    return cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 3), None, 0, 255, cv2.NORM_MINMAX)


def shifted(image: np.ndarray, right: float, down: float) -> np.ndarray:
    matrix = np.array([[1.0, 0.0, right], [0.0, 1.0, down]])
    return cv2.warpAffine(image, matrix, image.shape[::-1], borderMode=cv2.BORDER_REFLECT)


@pytest.mark.parametrize("largest_width_px", [800, 200])
@pytest.mark.parametrize("preset", ["ultrafast", "fast", "medium"])
def test_flow_leads_back_to_the_previous_image(preset: str, largest_width_px: int) -> None:
    previous = textured()
    field = DenseFlow(OpticalFlowOptions(preset, largest_width_px)).previous_from_current(
        shifted(previous, 6.0, -3.0), previous
    )
    inner = (slice(20, -20), slice(20, -20))
    assert field.flow.shape == (160, 320, 2)
    assert field.flow.dtype == np.float32
    np.testing.assert_allclose(np.median(field.flow[inner], axis=(0, 1)), (-6.0, 3.0), atol=0.2)
    assert np.median(field.miss[inner]) < 0.2


def test_what_was_hidden_misses_its_way_back() -> None:
    previous = textured()
    current = shifted(previous, 2.0, 0.0)
    current[60:110, 100:160] = shifted(textured()[::-1], 9.0, 0.0)[60:110, 100:160]
    miss = DenseFlow().previous_from_current(current, previous).miss
    assert np.median(miss[70:100, 110:150]) > 5 * np.median(miss[20:50, 200:300])


def test_the_same_images_give_the_same_bytes() -> None:
    previous, flow = textured(), DenseFlow()
    current = shifted(previous, 4.0, 1.0)
    first = flow.previous_from_current(current, previous)
    flow.previous_from_current(previous, current)
    again = flow.previous_from_current(current, previous)
    other = DenseFlow().previous_from_current(current, previous)
    for one, two in ((first, again), (first, other)):
        assert one.flow.tobytes() == two.flow.tobytes()
        assert one.miss.tobytes() == two.miss.tobytes()


def test_images_of_two_sizes_are_refused() -> None:
    with pytest.raises(InputError, match=r"\(160, 320\).*\(100, 320\)"):
        DenseFlow().previous_from_current(textured(100), textured(160))


def test_an_unknown_preset_is_refused() -> None:
    with pytest.raises(InputError, match=r"'slow'.*ultrafast, fast, medium"):
        DenseFlow(OpticalFlowOptions("slow"))
