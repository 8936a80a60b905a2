# SPDX-License-Identifier: Apache-2.0
"""Where movers lie, on masks whose answer is known."""

from pathlib import Path

import numpy as np
import pytest

from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.thesis.heat_map import HeatMap, plot_heat_map
from services.runtime.errors import InputError


def _heat(*areas: tuple[slice, slice], shape: tuple[int, int] = (60, 180)) -> HeatMap:
    heat = HeatMap()
    for rows, columns in areas:
        mask = np.full(shape, MaskClass.NON_MOVING, dtype=np.uint8)
        mask[rows, columns] = MaskClass.MOVING
        heat.add(mask)
    return heat


def test_movers_everywhere_are_even() -> None:
    heat = _heat(np.s_[:, :], np.s_[:, :])
    assert heat.central_third == pytest.approx(1 / 3)
    assert heat.central_ninth == pytest.approx(1 / 9)
    assert heat.entropy == pytest.approx(1.0)
    assert heat.mean_position == pytest.approx((0.5, 0.5))
    assert heat.spread == pytest.approx((1 / 12**0.5, 1 / 12**0.5), rel=1e-3)


def test_thirds_of_widths_that_three_does_not_divide_share_their_edges() -> None:
    assert _heat(np.s_[:, :], shape=(61, 181)).central_third == pytest.approx(1 / 3)
    assert _heat(np.s_[:, :], shape=(61, 182)).central_ninth == pytest.approx(1 / 9)


def test_movers_at_the_centre_and_at_the_left() -> None:
    centre, left = _heat(np.s_[28:32, 85:95]), _heat(np.s_[0:10, 0:10])
    assert (centre.central_third, centre.central_ninth) == (1.0, 1.0)
    assert (left.central_third, left.central_ninth) == (0.0, 0.0)
    assert left.entropy == pytest.approx(0.0, abs=1e-6)
    assert left.mean_position == pytest.approx((5 / 180, 5 / 60))
    both = _heat(np.s_[28:32, 85:95], np.s_[20:24, 0:10])
    assert both.central_third == pytest.approx(0.5)
    assert both.describe()["moving_share_of_pixels"] == pytest.approx(40 / (60 * 180))


def test_standing_cars_and_empty_frames_add_frames_but_no_mass() -> None:
    heat = _heat(np.s_[0:0, 0:0], np.s_[10:20, 10:20])
    assert (heat.frames, heat.frames_with_movers, heat.total) == (2, 1, 100.0)


def test_images_of_other_sizes_are_brought_to_the_first_ones() -> None:
    heat = _heat(np.s_[:, 0:90])
    mask = np.zeros((120, 360), dtype=np.uint8)
    mask[:, 180:] = MaskClass.MOVING
    heat.add(mask)
    assert heat.mass.shape == (60, 180)
    assert heat.mass == pytest.approx(np.ones((60, 180)))


def test_nothing_that_moves_is_said_in_one_line() -> None:
    with pytest.raises(InputError, match="nothing moves in 1 masks"):
        _heat(np.s_[0:0, 0:0]).describe()


def test_the_picture_is_the_same_again(tmp_path: Path) -> None:
    heat = _heat(np.s_[28:32, 85:95])
    for name in ("a.png", "b.png"):
        plot_heat_map(heat, tmp_path / name, "set")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
