# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

from services.formats.kitti_tracking import (
    NO_ID,
    TrackedBox,
    read_detections,
    read_kitti_tracking,
    write_kitti_tracking,
)
from services.runtime.errors import InputError

CAR = TrackedBox(3, 7, "Car", (10.5, 20.0, 60.25, 50.0), 0, 1, -1.5, (1.5, 1.75, 4.0), (-2.0, 1.5, 12.0), 0.5)
LINE = "3 7 Car 0 1 -1.5 10.5 20 60.25 50 1.5 1.75 4 -2 1.5 12 0.5"


def test_labels_and_results_come_back(tmp_path: Path) -> None:
    scored = TrackedBox(4, 8, "Pedestrian", (1.0, 2.0, 3.0, 4.0), score=0.75)
    write_kitti_tracking(tmp_path / "a.txt", [scored, CAR])
    assert read_kitti_tracking(tmp_path / "a.txt") == (CAR, scored)


def test_a_line_as_the_devkit_writes_it(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text(f"{LINE}\n")
    assert read_kitti_tracking(tmp_path / "a.txt") == (CAR,)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (LINE.rsplit(" ", 1)[0], ":1: 16 fields, expected 17 fields"),
        (LINE.replace("3 7", "-3 7", 1), ":1: frame '-3'"),
        (LINE.replace("60.25", "nan"), ":1: box right 'nan', expected a finite number"),
        (LINE.replace("60.25", "9"), ":1: box '10.5 20 9 50'"),
        (f"{LINE}\n{LINE}", ":2: id '7', expected each id once in frame 3"),
    ],
)
def test_wrong_labels_are_named(tmp_path: Path, line: str, said: str) -> None:
    (tmp_path / "a.txt").write_text(line)
    with pytest.raises(InputError) as error:
        read_kitti_tracking(tmp_path / "a.txt")
    assert said in str(error.value)


def test_detections_have_no_ids(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("0,2,298.3,165.1,458.2,293.4,8.2,1.9,1.8,4.7,-4.5,1.8,13.5,-2.1,-1.7\n")
    (box,) = read_detections(tmp_path / "a.txt")
    assert (box.category, box.object_id, box.score) == ("Car", NO_ID, 8.2)
    assert (box.size_m, box.place_m, box.rotation_y, box.alpha) == ((1.9, 1.8, 4.7), (-4.5, 1.8, 13.5), -2.1, -1.7)
    (tmp_path / "a.txt").write_text("0,9,298.3,165.1,458.2,293.4,8.2,1.9,1.8,4.7,-4.5,1.8,13.5,-2.1,-1.7\n")
    with pytest.raises(InputError, match="type '9', expected 1"):
        read_detections(tmp_path / "a.txt")


def test_real_labels_are_read_and_written_without_loss(shared_data: Path, tmp_path: Path) -> None:
    folder = shared_data / "kitti_tracking"
    for name in ("0000.txt", "0010.txt"):
        labels = read_kitti_tracking(folder / "label" / name)
        write_kitti_tracking(tmp_path / name, labels)
        assert sorted(read_kitti_tracking(tmp_path / name), key=str) == sorted(labels, key=str)
        assert len(labels) > 100
        assert len(read_detections(folder / "pointrcnn_car" / name)) > 100
