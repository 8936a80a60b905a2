# SPDX-License-Identifier: Apache-2.0
"""Lenses agree with OpenCV's, and bad ones are refused."""

from typing import Any

import cv2
import numpy as np
import pytest

from services.runtime.errors import InputError
from services.simulator.camera.camera import Camera
from services.simulator.drive import Drive
from services.simulator.options import DriveOptions

RADIAL = (-0.28, 0.08, 0.002, -0.001, -0.01)
FISHEYE = (0.03, -0.02, 0.006, -0.001)


def camera(**options: Any) -> Camera:
    return Camera.from_options(DriveOptions(width=200, height=80, **options))


def directions() -> np.ndarray:
    x, y = np.meshgrid(np.linspace(-0.7, 0.7, 15), np.linspace(-0.3, 0.3, 7))
    return np.stack([x.ravel(), y.ravel(), np.ones(x.size)], axis=1)


def test_radial_lens_projects_as_opencv_does() -> None:
    lens = camera(lens="radial", distortion=RADIAL)
    expected, _ = cv2.projectPoints(directions(), np.zeros(3), np.zeros(3), lens.k, np.array(RADIAL))
    assert np.abs(lens.project(7.0 * directions()) - expected[:, 0]).max() < 1e-9


def test_fisheye_projects_as_opencv_does() -> None:
    lens = camera(lens="fisheye", distortion=FISHEYE)
    expected, _ = cv2.fisheye.projectPoints(directions()[:, None], np.zeros(3), np.zeros(3), lens.k, np.array(FISHEYE))
    assert np.abs(lens.project(7.0 * directions()) - expected[:, 0]).max() < 1e-9


@pytest.mark.parametrize(
    "options",
    [
        {"lens": "radial", "distortion": RADIAL},
        {"lens": "radial", "distortion": (0.2, 0.0, 0.0, 0.0, 0.0)},
        {"lens": "fisheye", "distortion": FISHEYE},
        {"lens": "fisheye", "distortion": (0.0, 0.0, 0.0, 0.0), "fx_px": 78.0},
        {},
    ],
    ids=str,
)
def test_every_pixel_sees_what_is_projected_onto_it(options: dict[str, Any]) -> None:
    lens = camera(**options)
    columns, rows = lens.pixel_grid()
    for offset in ((0.0, 0.0), (0.34, 0.2)):
        x, y = lens.normalised(offset)
        place = lens.project(3.0 * np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float64))
        assert np.abs(place[..., 0] - columns - offset[0]).max() < 1e-3
        assert np.abs(place[..., 1] - rows - offset[1]).max() < 1e-3


def test_extent_is_the_change_from_pixel_to_pixel() -> None:
    lens = camera(lens="fisheye", distortion=FISHEYE)
    x, y = (grid.astype(np.float64) for grid in lens.normalised())
    by_column, by_row = (np.gradient(np.stack([x, y]), axis=axis) for axis in (2, 1))
    area = np.abs(by_column[0] * by_row[1] - by_column[1] * by_row[0])
    inner = np.s_[1:-1, 1:-1]
    assert np.sqrt(area)[inner] == pytest.approx(lens.pixel_extent[inner], rel=2e-3)


def test_what_lies_outside_a_barrel_lens_does_not_fold_back_into_the_image() -> None:
    lens = camera(lens="radial", distortion=(-0.3, 0.0, 0.0, 0.0, 0.0), fx_px=180.0)
    place = lens.project(np.array([[x, 0.0, 1.0] for x in np.linspace(0.0, 30.0, 300)]))[:, 0]
    assert (np.diff(place) > 0.0).all()
    assert place[-1] > 1000.0


def test_window_holds_every_pixel_that_looks_into_a_range() -> None:
    lens = camera(lens="radial", distortion=RADIAL)
    x, y = lens.normalised()
    low, high = (
        np.array([[0.11, -0.2], [5.0, 0.0], [np.inf, np.inf]]),
        np.array([[0.35, 0.05], [6.0, 0.1], [-np.inf] * 2]),
    )
    window, beside, nowhere = lens.windows(low, high)
    assert window is not None
    inside = (x >= low[0, 0]) & (x <= high[0, 0]) & (y >= low[0, 1]) & (y <= high[0, 1])
    assert inside.any()
    assert inside.sum() == inside[window].sum()
    assert inside[window].mean() > 0.5
    assert beside is nowhere is None


@pytest.mark.parametrize(
    "options",
    [
        {"lens": "radial", "distortion": (-0.9, 0.0, 0.0, 0.0, 0.0)},
        {"lens": "fisheye", "distortion": (0.0, 0.0, 0.0, 0.0), "fx_px": 41.0},
        {"lens": "fisheye", "distortion": (-1.0, 0.0, 0.0, 0.0)},
    ],
    ids=str,
)
def test_a_lens_that_cannot_fill_the_image_is_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"distortion=.*: expected .* every pixel looks within 85 degrees") as caught:
        camera(**options)
    assert "\n" not in str(caught.value)


def test_depth_through_a_lens_is_that_along_the_axis() -> None:
    """A pixel of the lens' image and the pixel of an ideal one that looks the same way show the same depth."""
    size = {"width": 160, "height": 64}
    ideal = Drive(DriveOptions(**size))
    bent = Drive(DriveOptions(**size, lens="fisheye", distortion=FISHEYE))
    expected, found = ideal.render(40).depth_m, bent.render(40).depth_m
    x, y = (grid.astype(np.float64) for grid in bent.camera.normalised())
    place = ideal.camera.project(np.stack([x, y, np.ones_like(x)], axis=-1))
    inside = (place[..., 0] > 1) & (place[..., 0] < 158) & (place[..., 1] > 1) & (place[..., 1] < 62)
    nearest = np.where(inside[..., None], np.rint(place), 0).astype(int)
    same = expected[nearest[..., 1], nearest[..., 0]]
    compared = inside & (same > 0.0) & (found > 0.0)
    assert compared.mean() > 0.4
    assert np.median(np.abs(found / np.maximum(same, 0.1) - 1.0)[compared]) < 0.01
