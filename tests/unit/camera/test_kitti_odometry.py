# SPDX-License-Identifier: Apache-2.0
"""KITTI odometry folders: what they give, and what is said of a bad one."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.camera.sources.folders.number_rows import even_times_ns, read_times_ns, rows_of_images
from services.camera.sources.kitti.odometry import KittiOdometry, is_kitti_folder
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError

P0 = "P0: 20 0 16 0 0 20 12 0 0 0 1 0"
IDENTITY = "1 0 0 0 0 1 0 0 0 0 1 0"


def _frame(source: KittiOdometry, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def test_mono_frames_carry_time_name_and_calibration(kitti: Path) -> None:
    source = KittiOdometry(kitti)
    assert (source.frame_count, source.notes) == (3, ())
    assert source.rate_hz == pytest.approx(1 / 0.1036)
    frames = [_frame(source, index) for index in range(3)]
    assert [frame.name for frame in frames] == ["000000", "000001", "000002"]
    assert [frame.timestamp_ns for frame in frames] == [0, 103_600_000, 207_200_000]
    assert [int(frame.image.pixels[0, 0]) for frame in frames] == [0, 10, 20]
    assert {record.timestamp_ns for record in (frames[1].image, frames[1].calibration)} == {103_600_000}
    np.testing.assert_array_equal(frames[0].calibration.intrinsics, [[20, 0, 16], [0, 20, 12], [0, 0, 1]])
    assert (frames[0].calibration.width, frames[0].calibration.height) == (32, 24)
    assert frames[0].image_right is None
    assert frames[0].true_pose is None
    assert source.frame(3) is None


def test_frames_in_any_order_are_the_same(kitti: Path) -> None:
    source = KittiOdometry(kitti)
    last, first = _frame(source, 2), _frame(source, 0)
    assert int(last.image.pixels[5, 5]) == 20
    assert int(first.image.pixels[5, 5]) == 0


def test_stereo_gives_the_baseline(stereo: Path) -> None:
    frame = _frame(KittiOdometry(stereo), 1)
    assert frame.image_right is not None
    assert frame.calibration_right is not None
    assert frame.calibration_right.projection is not None
    assert frame.calibration_right.projection[0, 3] == -20 * 0.5
    assert frame.calibration_right.frame_id == frame.image_right.frame_id != frame.image.frame_id
    assert _frame(KittiOdometry(stereo, stereo=False), 1).image_right is None


def test_colour_images_are_preferred_and_carry_their_own_camera(kitti: Path, make_images: Callable[..., Path]) -> None:
    make_images("sequences/00/image_2")
    make_images("sequences/00/image_3")
    p2, p3 = "P2: 20 0 16 2 0 20 12 0 0 0 1 0", "P3: 20 0 16 -8 0 20 12 0 0 0 1 0"
    (kitti / "calib.txt").write_text(f"{P0}\n{p2}\n{p3}\nTr: {IDENTITY}\n")
    (kitti / "poses.txt").write_text(f"{IDENTITY}\n" * 3)
    colour = _frame(KittiOdometry(kitti), 0)
    assert colour.calibration_right is not None
    assert colour.calibration_right.projection is not None
    assert colour.calibration_right.projection[0, 3] == -10
    assert colour.true_pose is not None
    # P2 = K [I | t] with x in camera 2 = x in camera 0 + 0.1 m: camera 2 sits 0.1 m to the left.
    np.testing.assert_allclose(colour.true_pose.world_from_camera[:3, 3], [-0.1, 0, 0])
    grey = _frame(KittiOdometry(kitti, left="image_0"), 0)
    assert grey.true_pose is not None
    np.testing.assert_array_equal(grey.true_pose.world_from_camera, np.eye(4))


def test_official_place_of_poses(kitti: Path) -> None:
    poses = kitti.parent.parent / "poses"
    poses.mkdir()
    (poses / "00.txt").write_text(f"{IDENTITY}\n1 0 0 0.5 0 1 0 0 0 0 1 7\n{IDENTITY}\n{IDENTITY}\n")
    pose = _frame(KittiOdometry(kitti), 1).true_pose
    assert pose is not None
    np.testing.assert_array_equal(pose.world_from_camera[:3, 3], [0.5, 0, 7])


def test_without_times_and_p2_it_says_what_it_assumes(tmp_path: Path, make_images: Callable[..., Path]) -> None:
    make_images("traffic/image_2", suffix=".jpg")
    folder = tmp_path / "traffic"
    (folder / "calib.txt").write_text(f"{P0}\n")
    assert is_kitti_folder(folder)
    source = KittiOdometry(folder)
    assert [_frame(source, index).timestamp_ns for index in range(3)] == [0, 100_000_000, 200_000_000]
    assert any("no P2: P0 is taken" in note for note in source.notes)
    assert any("assumed at 10 Hz" in note for note in source.notes)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("P0: 20 0 16 0 0 20 12 0 0 0 1\n", r"calib\.txt line 1: 11 numbers, expected 12"),
        (f"{P0}\nP1: {'1 ' * 13}\n", r"calib\.txt line 2: 13 numbers, expected 12"),
        ("P0: 20 0 16 0 0 20 x 0 0 0 1 0\n", r"calib\.txt line 1: 'x' is not a number"),
        ("P0: 20 0 nan 0 0 20 12 0 0 0 1 0\n", r"calib\.txt line 1: 'nan', expected a finite number"),
        ("P0: 0 0 16 0 0 20 12 0 0 0 1 0\n", r"calib\.txt line 1: focal lengths 0 and 20 px"),
        ("S: 1242 375\n", r"calib\.txt: no projection matrix, expected a line 'P0: <12 numbers>'"),
        ("", r"calib\.txt: no projection matrix"),
        (None, r"calib\.txt: no such file, expected KITTI's calib\.txt"),
    ],
)
def test_bad_calibration_is_named_by_line(kitti: Path, text: str | None, said: str) -> None:
    (kitti / "calib.txt").unlink()
    if text is not None:
        (kitti / "calib.txt").write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        KittiOdometry(kitti)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0.0\n0.1\n", r"times\.txt: 2 times, expected 3, one for every image"),
        ("0.0\nnow\n0.2\n", r"times\.txt line 2: 'now', expected one time in seconds"),
        ("0.0\nnan\n0.2\n", r"times\.txt line 2: 'nan', expected one time"),
        ("0.0\n1e999999\n2\n", r"times\.txt line 2"),
        ("0.0\n0.2\n0.2\n", r"times\.txt line 3: time 0\.2 s, expected times that increase"),
        ("-1\n0.2\n0.3\n", r"times\.txt line 1: time -1 s, expected times that increase from 0"),
        ("1e30\n0\n1\n", r"times\.txt line 1: time 1e30 s"),
    ],
)
def test_bad_times_are_named_by_line(kitti: Path, text: str, said: str) -> None:
    (kitti / "times.txt").write_text(text)
    with pytest.raises(InputError, match=said):
        KittiOdometry(kitti)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{IDENTITY}\n", r"poses\.txt: 1 poses, expected 3"),
        ("0 0 0 0 0 0 0 0 0 0 0 0\n" * 3, r"poses\.txt: pose 1 of 3 is not a rotation"),
        (f"{IDENTITY}\n" * 2 + "1 2 3\n", r"poses\.txt line 3: 3 numbers, expected 12"),
        (f"{IDENTITY}\n" * 2 + IDENTITY.replace("0", "nan"), r"poses\.txt line 3: 'nan', expected a finite number"),
    ],
)
def test_bad_poses_are_named_by_line(kitti: Path, text: str, said: str) -> None:
    (kitti / "poses.txt").write_text(text)
    with pytest.raises(InputError, match=said):
        KittiOdometry(kitti)


def test_stereo_that_does_not_fit_together(stereo: Path, make_images: Callable[..., Path]) -> None:
    (stereo / "image_1" / "000002.png").unlink()
    with pytest.raises(InputError, match=r"image_1: no 000002, expected one for every image in .*image_0"):
        KittiOdometry(stereo)
    make_images("sequences/00/image_1", size=(20, 20))
    with pytest.raises(InputError, match="image_1: images of 20x20 px, expected 32x24 as in image_0"):
        KittiOdometry(stereo)
    make_images("sequences/00/image_1")
    (stereo / "image_1" / "000001.png").rename(stereo / "image_1" / "000009.png")
    with pytest.raises(InputError, match="image_1: no 000001, expected one for every image"):
        KittiOdometry(stereo)
    make_images("sequences/00/image_1")
    (stereo / "image_1" / "000009.png").rename(stereo / "000009.png")
    (stereo / "calib.txt").write_text(f"{P0}\n")
    with pytest.raises(InputError, match="no line 'P1:'"):
        KittiOdometry(stereo)


def test_times_are_exact_to_the_decimal(tmp_path: Path) -> None:
    path = tmp_path / "times.txt"
    path.write_text("0.100000001\n1403636579.763555555\n")
    assert read_times_ns(path, [Path("a.png"), Path("b.png")]) == [100_000_001, 1_403_636_579_763_555_555]
    assert even_times_ns(range(4), 30.0) == [0, 33_333_333, 66_666_667, 100_000_000]


def test_real_sequences(shared_data: Path) -> None:
    mono = KittiOdometry(shared_data / "kitti/sequences/03")
    assert (mono.frame_count, mono.notes) == (300, ())
    frame = _frame(mono, 299)
    assert frame.image.pixels.shape == (375, 1242)
    assert frame.timestamp_ns == 299 * 103_600_000
    assert frame.true_pose is not None
    stereo = _frame(KittiOdometry(shared_data / "kitti/sequences/06"), 50)
    assert stereo.calibration_right is not None
    assert stereo.calibration_right.projection is not None
    baseline_m = -stereo.calibration_right.projection[0, 3] / stereo.calibration.intrinsics[0, 0]
    assert baseline_m == pytest.approx(0.537, abs=1e-3)
    assert stereo.image_right is not None
    # Which image is the left one shows in the disparities: the wrong way round, few pixels find a partner.
    matcher = cv2.StereoSGBM.create(numDisparities=64, blockSize=7)
    disparity = matcher.compute(stereo.image.pixels, stereo.image_right.pixels)[150:]
    assert (disparity > 0).mean() > 0.7
    colour = _frame(KittiOdometry(shared_data / "kitti_traffic"), 77)
    assert colour.image.pixels.shape == (375, 1242, 3)


def test_a_missing_image_keeps_the_times_and_poses_of_the_others(kitti: Path) -> None:
    (kitti / "poses.txt").write_text("".join(f"1 0 0 0 0 1 0 0 0 0 1 {z}\n" for z in range(3)))
    (kitti / "image_0" / "000001.png").unlink()
    frames = [_frame(KittiOdometry(kitti), index) for index in range(2)]
    assert [frame.timestamp_ns for frame in frames] == [0, 207_200_000]
    assert [frame.true_pose.world_from_camera[2, 3] for frame in frames if frame.true_pose] == [0, 2]


@pytest.mark.parametrize(
    ("names", "rows", "expected"),
    [
        (("000000", "000001"), 9, [0, 1]),
        (("000001", "000002"), 9, [0, 1]),
        (("000000", "000002"), 3, [0, 2]),
        (("1", "3"), 3, [0, 2]),
        (("000004", "000005"), 9, [4, 5]),
        (("3", "12"), 9, [0, 1]),
        (("left", "right"), 9, [0, 1]),
        (("7", "8"), 2, [0, 1]),
    ],
)
def test_names_tell_the_rows_where_images_are_missing(names: tuple[str, ...], rows: int, expected: list[int]) -> None:
    assert rows_of_images([Path(f"{name}.png") for name in names], rows) == expected


@pytest.mark.parametrize(
    ("right", "said"),
    [
        ("20 0 16 0 0 20 12 0 0 0 1 0", "camera 1 at 0 m to the right of camera 0, expected above 0"),
        ("20 0 16 10 0 20 12 0 0 0 1 0", "camera 1 at -0.5 m to the right of camera 0, expected above 0"),
        ("25 0 16 -10 0 20 12 0 0 0 1 0", "P0 and P1 differ in their first three columns, expected a rectified pair"),
    ],
)
def test_a_pair_that_is_none_is_refused(stereo: Path, right: str, said: str) -> None:
    (stereo / "calib.txt").write_text(f"{P0}\nP1: {right}\n")
    with pytest.raises(InputError, match=said):
        KittiOdometry(stereo)


def test_windows_files_with_tabs_are_read(kitti: Path) -> None:
    (kitti / "calib.txt").write_bytes(b"\xef\xbb\xbf" + P0.replace(": ", ":\t").encode() + b"\r\n")
    (kitti / "times.txt").write_bytes(b"\xef\xbb\xbf0.0\r\n0.1\r\n0.2\r\n")
    assert _frame(KittiOdometry(kitti), 2).timestamp_ns == 200_000_000
