# SPDX-License-Identifier: Apache-2.0
"""Flow as colours: what Baker's wheel says of the directions that anyone can check by eye."""

import numpy as np

from services.evaluation.pictures.flow_colours import colour_wheel, flow_colours


def colour_of(u: float, v: float, longest_px: float = 10.0) -> tuple[int, int, int]:
    red, green, blue = flow_colours(np.array([[[u, v]]]), longest_px)[0, 0].tolist()
    return red, green, blue


def test_wheel_has_the_papers_55_hues_and_is_continuous() -> None:
    wheel = colour_wheel()
    assert wheel.shape == (55, 3)
    steps = np.abs(np.diff(np.vstack([wheel, wheel[:1]]), axis=0)).sum(axis=1)
    assert steps.max() <= 0.2501
    assert (wheel.max(axis=1) == 1.0).all()


def test_directions_have_the_papers_hues() -> None:
    assert colour_of(10, 0) == (255, 0, 0)
    red, green, blue = colour_of(0, 10)
    assert min(red, green) > 200
    assert blue == 0
    red, green, blue = colour_of(-10, 0)
    assert green > 100
    assert (red, blue) == (0, 255)
    red, green, blue = colour_of(0, -10)
    assert blue > 200
    assert green == 0


def test_length_is_saturation_and_too_long_is_dark() -> None:
    assert colour_of(0, 0) == (255, 255, 255)
    assert colour_of(5, 0) == (255, 128, 128)
    assert colour_of(20, 0) == (191, 0, 0)


def test_what_is_not_known_is_black_and_sets_no_scale() -> None:
    flow = np.array([[[4.0, 0.0], [1000.0, 0.0], [np.nan, 0.0]]])
    picture = flow_colours(flow, valid=np.array([[True, False, True]]))
    assert picture[0].tolist() == [[255, 0, 0], [0, 0, 0], [0, 0, 0]]


def test_a_still_image_is_white() -> None:
    assert (flow_colours(np.zeros((2, 3, 2))) == 255).all()
