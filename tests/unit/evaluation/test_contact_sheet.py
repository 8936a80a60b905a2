# SPDX-License-Identifier: Apache-2.0
"""The contact sheet: what is where on it, and that it stays small."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.evaluation.pictures.contact_sheet import COLUMNS, SheetRow, draw_contact_sheet, write_sheet
from services.evaluation.pictures.tints import depth_colours, instance_colours, moving_tint
from services.runtime.errors import ResourceError


def _row(height: int = 60, width: int = 100) -> SheetRow:
    labels = np.zeros((height, width), np.uint16)
    labels[10:30, 10:40], labels[10:30, 60:90] = 5, 6
    shape = (height, width)
    return SheetRow(
        "seed\n1",
        np.full((*shape, 3), 100, np.uint8),
        np.full(shape, 10.0, np.float32),
        labels,
        frozenset({6}),
        np.full((*shape, 2), (4.0, 0.0), np.float32),
        np.ones(shape, bool),
    )


def test_what_moves_is_red_and_what_stands_is_green() -> None:
    row = _row()
    picture = moving_tint(row.image, row.labels, row.moving).astype(int)
    blue, green, red = picture[20, 20]
    assert green > max(blue, red) + 30
    blue, green, red = picture[20, 70]
    assert red > max(blue, green) + 30
    assert np.ptp(picture[50, 50]) == 0


def test_near_is_redder_than_far_and_sky_is_pale() -> None:
    picture = depth_colours(np.array([[4.0, 12.0, 70.0, 0.0]], np.float32)).astype(int)
    redness = picture[0, :, 2] - picture[0, :, 0]
    assert redness[0] > redness[1] > redness[2]
    assert (picture[0, 3] > 200).all()


def test_neighbouring_ids_are_told_apart_and_an_id_keeps_its_colour() -> None:
    labels = np.arange(300, dtype=np.uint16).reshape(1, -1)
    picture = instance_colours(labels).astype(int)
    assert np.abs(np.diff(picture[0], axis=0)).sum(axis=1).min() > 60
    assert np.array_equal(instance_colours(labels[:, 50:51]), picture[:, 50:51])


def test_rows_stand_below_each_other_with_all_columns() -> None:
    row = _row()
    sheet = draw_contact_sheet([row, replace(row, image=np.full_like(row.image, 200))])
    height, width = sheet.shape[:2]
    assert width <= 2500
    first, second = sheet[60, 100], sheet[60 + 66, 100]
    assert first.tolist() == [100, 100, 100]
    assert second.tolist() == [200, 200, 200]
    flow_cell = sheet[70, width - 50]
    assert flow_cell.tolist() == [0, 0, 255]
    assert height == 40 + 2 * 66
    assert len(row.cells()) == len(COLUMNS)


def test_wide_images_are_made_to_fit() -> None:
    sheet = draw_contact_sheet([_row(375, 1242)] * 2)
    assert 2400 <= sheet.shape[1] <= 2500


def test_a_picture_that_packs_badly_stays_below_the_limit(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (1500, 2400, 3)).astype(np.uint8)
    noise = cv2.GaussianBlur(noise, (5, 5), 0)
    path = tmp_path / "docs" / "sheet.jpg"
    write_sheet(path, noise)
    assert 0 < path.stat().st_size <= 1_500_000
    assert cv2.imread(str(path)).shape == noise.shape


def test_a_place_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ResourceError, match=r"file/sheet\.jpg: cannot be written"):
        write_sheet(tmp_path / "file" / "sheet.jpg", np.zeros((10, 10, 3), np.uint8))
