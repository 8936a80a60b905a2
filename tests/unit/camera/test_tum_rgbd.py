# SPDX-License-Identifier: Apache-2.0
"""TUM RGB-D folders: association by time, depth, the cameras the folder's name tells, and truth between samples."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from services.camera.sources.association import nearest_pairs
from services.camera.sources.folders.tum_rgbd import TumRgbd
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError

SIZE = (32, 24)
CALIBRATION = "fx = 20.0\nfy = 21.0\ncx = 16.0\ncy = 12.0\nwidth = 32\nheight = 24\n"
COLOUR_S = ("100.000000", "100.040000", "100.080000", "100.300000")
DEPTH_S = ("99.990000", "100.041000", "100.099000", "100.500000")


def _write(folder: Path, size: tuple[int, int] = SIZE) -> Path:
    (folder / "rgb").mkdir(parents=True)
    (folder / "depth").mkdir()
    for index, (colour, depth) in enumerate(zip(COLOUR_S, DEPTH_S, strict=True)):
        cv2.imwrite(str(folder / f"rgb/{colour}.png"), np.full((*size[::-1], 3), (index, 0, 100), np.uint8))
        levels = np.full(size[::-1], 5000 * (index + 1), np.uint16)
        levels[0, 0] = 0
        cv2.imwrite(str(folder / f"depth/{depth}.png"), levels)
    for name, times in (("rgb", COLOUR_S), ("depth", DEPTH_S)):
        rows = "".join(f"{time} {name}/{time}.png\n" for time in times)
        (folder / f"{name}.txt").write_text(f"# {name} images\n# timestamp filename\n{rows}")
    # The camera goes along x at 1 m/s and turns about z at 1 rad/s; sampled at 100 Hz, until 100.2 s.
    truth = [(99.9 + step / 100, step / 100) for step in range(31)]
    (folder / "groundtruth.txt").write_text(
        "# timestamp tx ty tz qx qy qz qw\n"
        + "".join(f"{t:.4f} {x:.4f} 2 3 0 0 {np.sin(x / 2):.9f} {np.cos(x / 2):.9f}\n" for t, x in truth)
    )
    return folder


@pytest.fixture
def tum(tmp_path: Path) -> Path:
    folder = _write(tmp_path / "room")
    (folder / "calibration.toml").write_text(CALIBRATION)
    return folder


def _frame(source: TumRgbd, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def test_colour_and_depth_come_in_pairs(tum: Path) -> None:
    source = TumRgbd(tum)
    assert source.frame_count == 3
    assert source.frame(3) is None
    assert "1 of 4 colour images have no depth image within 0.02 s and are left out" in source.notes
    frame = _frame(source, 1)
    assert (frame.name, frame.timestamp_ns) == ("100.040000", 100_040_000_000)
    assert frame.image.pixels[3, 4].tolist() == [1, 0, 100]
    assert frame.depth is not None
    assert frame.depth.depth_m.dtype == np.float32
    assert (frame.depth.depth_m[0, 0], frame.depth.depth_m[3, 4]) == (0.0, 2.0)
    assert frame.depth.timestamp_ns == frame.timestamp_ns
    assert source.rate_hz == pytest.approx(25)
    colour_only = TumRgbd(tum, depth=False)
    assert colour_only.frame_count == 4
    assert _frame(colour_only, 3).depth is None


def test_truth_is_interpolated_and_ends_where_it_ends(tum: Path) -> None:
    (tum / "rgb.txt").write_text("100.003 rgb/100.040000.png\n100.215 rgb/100.080000.png\n100.3 rgb/100.300000.png\n")
    source = TumRgbd(tum, depth=False)
    pose = _frame(source, 0).true_pose
    assert pose is not None
    angle = 0.103
    expected = np.eye(4)
    expected[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    expected[:3, 3] = (0.103, 2, 3)
    np.testing.assert_allclose(pose.world_from_camera, expected, atol=1e-6)
    last = _frame(source, 1).true_pose
    assert last is not None
    assert last.world_from_camera[0, 3] == pytest.approx(0.3)
    assert _frame(source, 2).true_pose is None
    assert any(note.startswith("1 of 3 frames have no true pose") for note in source.notes)


def test_the_folders_name_tells_the_camera(tmp_path: Path) -> None:
    source = TumRgbd(_write(tmp_path / "rgbd_dataset_freiburg2_desk", (640, 480)))
    calibration = _frame(source, 0).calibration
    assert calibration.intrinsics.tolist() == [[520.9, 0, 325.1], [0, 521.0, 249.7], [0, 0, 1]]
    assert calibration.distortion == (0.2312, -0.7849, -0.0033, -0.0001, 0.9172)
    assert any("camera of freiburg2 is assumed" in note for note in source.notes)
    (tmp_path / "rgbd_dataset_freiburg2_desk/calibration.toml").write_text(
        CALIBRATION.replace("32", "640").replace("24", "480")
    )
    own = TumRgbd(tmp_path / "rgbd_dataset_freiburg2_desk")
    assert _frame(own, 0).calibration.intrinsics[0, 0] == 20
    assert not any("assumed" in note for note in own.notes)


def test_the_nearest_pairs_go_first() -> None:
    assert nearest_pairs([0, 10, 20], [9, 11, 40], 15) == [(1, 0), (2, 1)]
    assert nearest_pairs([0], [16], 15) == []
    assert nearest_pairs([100, 200], [99, 100, 201], 15) == [(0, 1), (1, 2)]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("rgb.txt", "# nothing\n", r"rgb\.txt: no images listed"),
        ("rgb.txt", "100.0\n", r"rgb\.txt line 1: '100\.0', expected a time in seconds and a file's name"),
        ("rgb.txt", "now rgb/1.png\n", r"rgb\.txt line 1: 'now', expected one time in seconds"),
        ("rgb.txt", "1.0 rgb/1.png\n", r"rgb/1\.png: cannot be read \(No such file"),
        ("depth.txt", "7.5 depth/99.990000.png\n", r"no image of rgb\.txt \(from 100\.000 s\) has one of depth\.txt"),
        ("groundtruth.txt", "100.0 1 2 3 0 0 0\n", r"groundtruth\.txt:1: 7 numbers, expected 8"),
        ("groundtruth.txt", "100.0 1 2 x 0 0 0 1\n", r"groundtruth\.txt:1: .*'x'"),
    ],
)
def test_bad_files_are_named_by_line(tum: Path, name: str, text: str, said: str) -> None:
    (tum / name).write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        TumRgbd(tum, depth=name != "rgb.txt")
    assert "\n" not in str(caught.value)


def test_bad_depth_and_calibration(tum: Path) -> None:
    cv2.imwrite(str(tum / "depth/99.990000.png"), np.zeros(SIZE[::-1], np.uint8))
    with pytest.raises(InputError, match=r"99\.990000\.png: uint8 of shape \(24, 32\), expected one channel"):
        TumRgbd(tum).frame(0)
    cv2.imwrite(str(tum / "depth/99.990000.png"), np.zeros((5, 5), np.uint16))
    with pytest.raises(InputError, match=r"99\.990000\.png: 5x5 px, expected 32x24 as the colour images"):
        TumRgbd(tum)
    (tum / "calibration.toml").unlink()
    with pytest.raises(InputError, match=r"no calibration: expected .*calibration\.toml"):
        TumRgbd(tum, depth=False)
    with pytest.raises(InputError, match=r"32x24 px, expected 640x480 as of freiburg1's camera"):
        TumRgbd(tum.rename(tum.parent / "freiburg1_small"), depth=False)


def test_lists_of_windows_with_tabs_and_odd_names_are_read(tum: Path) -> None:
    (tum / "rgb").rename(tum / "f\u00e4rg bilder")
    rows = "".join(f"{time}\tf\u00e4rg bilder/{time}.png\r\n" for time in COLOUR_S)
    (tum / "rgb.txt").write_bytes(b"\xef\xbb\xbf" + rows.encode())
    assert _frame(TumRgbd(tum, depth=False), 3).name == COLOUR_S[3]
