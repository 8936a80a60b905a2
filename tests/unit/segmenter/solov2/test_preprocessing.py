# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from services.segmenter.solov2.preprocessing import fitted_hw, prepare


@pytest.mark.parametrize(
    ("height", "width", "expected"),
    [(375, 1242, (257, 852)), (448, 852, (448, 852)), (480, 640, (448, 597)), (1000, 500, (852, 426))],
)
def test_fits_the_box_long_side_to_long_side(height: int, width: int, expected: tuple[int, int]) -> None:
    assert fitted_hw(height, width, (852, 448)) == expected


def test_channels_are_rgb_normalised_and_padded_with_zeros() -> None:
    image = np.zeros((10, 20, 3), np.uint8)
    image[...] = (10, 20, 30)
    given = prepare(image, (40, 20))
    assert given.pixels.shape == (1, 3, 32, 64)
    assert (given.resized_hw, given.original_hw) == ((20, 40), (10, 20))
    np.testing.assert_allclose(
        given.pixels[0, :, 3, 3], [(30 - 123.675) / 58.395, (20 - 116.28) / 57.12, (10 - 103.53) / 57.375], rtol=1e-5
    )
    assert not given.pixels[:, :, 20:].any()
    assert not given.pixels[:, :, :, 40:].any()


def test_a_grey_image_is_one_of_three_equal_channels() -> None:
    grey = np.arange(200, dtype=np.uint8).reshape(10, 20)
    colour = np.repeat(grey[..., None], 3, axis=2)
    np.testing.assert_array_equal(prepare(grey, (40, 20)).pixels, prepare(colour, (40, 20)).pixels)
