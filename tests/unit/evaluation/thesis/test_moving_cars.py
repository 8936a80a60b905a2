# SPDX-License-Identifier: Apache-2.0
"""Which car moves, told by boxes; and the data set that says so."""

from pathlib import Path

import numpy as np
import pytest

from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.thesis.moseg import derive_masks
from services.evaluation.thesis.moving_cars import moving_cars
from services.formats.kitti_moseg import MovingBox, moseg_frames, read_boxes, read_cars
from services.formats.png import read_png, write_png
from services.runtime.errors import InputError

MOVES, STANDS, NOTHING = MaskClass.MOVING, MaskClass.NON_MOVING, MaskClass.BACKGROUND


def _cars(*areas: tuple[int, int, int, int], values: tuple[int, ...] = ()) -> np.ndarray:
    """Cars that fill (x1, y1, x2, y2) each."""
    cars = np.zeros((40, 80), dtype=np.uint8)
    for place, (x1, y1, x2, y2) in enumerate(areas):
        cars[y1:y2, x1:x2] = values[place] if values else 255
    return cars


def _box(x1: float, y1: float, x2: float, y2: float, moving: bool = True) -> MovingBox:
    return MovingBox(moving, x1, y1, x2, y2)


def test_a_car_moves_whole_where_a_moving_box_covers_half_of_it() -> None:
    cars = _cars((10, 10, 30, 20), (50, 10, 70, 20))
    mask = moving_cars(cars, [_box(8, 8, 20, 22), _box(45, 5, 59, 25)])
    assert (mask[10:20, 10:30] == MOVES).all()
    assert (mask[10:20, 50:59] == MOVES).all()  # less than half of it: taken for cars that touch
    assert (mask[10:20, 59:70] == STANDS).all()
    assert (mask[cars == 0] == NOTHING).all()


def test_a_car_in_no_box_or_in_a_standing_one_stands() -> None:
    mask = moving_cars(_cars((10, 10, 30, 20), (50, 10, 70, 20)), [_box(48, 8, 72, 22, moving=False)])
    assert not (mask == MOVES).any()
    assert (mask > 0).sum() == 400


def test_a_standing_car_within_the_box_of_a_moving_one_is_told_by_its_own_box() -> None:
    cars = _cars((10, 5, 60, 35), (30, 2, 40, 5), values=(1, 2))
    mask = moving_cars(cars, [_box(10, 0, 60, 35), _box(30, 2, 40, 6, moving=False)])
    assert (mask[cars == 1] == MOVES).all()
    assert (mask[cars == 2] == STANDS).all()


def test_cars_that_touch_are_parted_by_their_boxes_and_the_nearer_one_is_in_front() -> None:
    cars = _cars((10, 10, 40, 25), (40, 10, 60, 20))
    boxes = [_box(10, 10, 42, 25), _box(35, 8, 60, 20, moving=False)]
    for given in (boxes, boxes[::-1]):
        mask = moving_cars(cars, given)
        assert (mask[10:20, 10:42] == MOVES).all()
        assert (mask[10:20, 42:60] == STANDS).all()
        assert (mask[20:25, 10:40] == MOVES).all()


def test_boxes_may_reach_beyond_the_image() -> None:
    mask = moving_cars(_cars((0, 30, 20, 40)), [_box(-30.0, 25.0, 21.0, 60.0), _box(100.0, 50.0, 120.0, 60.0)])
    assert (mask[30:40, 0:20] == MOVES).all()


def _data_set(folder: Path, boxes: str) -> Path:
    for name in ("images", "mask", "boxes"):
        (folder / "testing" / name).mkdir(parents=True)
    write_png(folder / "testing" / "mask" / "drive_0001.png", _cars((10, 10, 30, 20), (50, 10, 70, 20)))
    (folder / "testing" / "boxes" / "drive_0001.txt").write_text(boxes)
    return folder


def test_masks_are_written_and_counted(tmp_path: Path) -> None:
    data = _data_set(tmp_path / "data", "3 1 8.0 8.0 22.0 32.0 1\n4 0 8.0 48.0 22.0 72.0 1\n5 1 9.0 9.0 9.0 30.0 1\n")
    frames = moseg_frames(data, None)
    assert read_boxes(frames[0]) == (_box(8, 8, 32, 22), _box(48, 8, 72, 22, moving=False))
    derived = derive_masks(frames, tmp_path)
    assert (derived.frames, derived.boxes, derived.moving_boxes, derived.frames_with_movers) == (1, 2, 1, 1)
    assert derived.moving_share == pytest.approx(0.5)
    mask = read_png(tmp_path / "drive_0001.png", "a mask")
    assert (mask[10:20, 10:30] == MOVES).all()
    assert (mask[10:20, 50:70] == STANDS).all()


@pytest.mark.parametrize(
    ("line", "part"),
    [
        ("1 1 8 8 22", "5 fields, expected a line of 'id moving y1 x1 y2 x2'"),
        ("1 2 8 8 22 32", "moving '2', expected 0 or 1"),
        ("1 1 8 eight 22 32", "x1 'eight', expected a finite number"),
    ],
)
def test_boxes_of_another_form_are_refused_with_file_and_line(tmp_path: Path, line: str, part: str) -> None:
    frame = moseg_frames(_data_set(tmp_path, f"1 0 1 1 5 5\n{line}\n"), "testing")[0]
    with pytest.raises(InputError, match=r"drive_0001\.txt:2: ") as raised:
        read_boxes(frame)
    assert part in str(raised.value)


def test_another_layout_is_refused_and_the_extended_release_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected KITTI MoSeg's images/"):
        moseg_frames(tmp_path, None)
    (tmp_path / "2011_09_26_drive_0001" / "Text_data_Output").mkdir(parents=True)
    with pytest.raises(InputError, match="of the extended release"):
        moseg_frames(tmp_path, None)


def test_a_mask_without_boxes_and_a_coloured_one_are_refused(tmp_path: Path) -> None:
    data = _data_set(tmp_path, "")
    frame = moseg_frames(data, "testing")[0]
    write_png(frame.mask, np.dstack([_cars((1, 1, 5, 5)), _cars(), _cars()]))
    with pytest.raises(InputError, match="colours, expected a grey mask"):
        read_cars(frame)
    frame.boxes.unlink()
    with pytest.raises(InputError, match=r"expected the boxes of drive_0001\.png"):
        moseg_frames(data, "testing")
