# SPDX-License-Identifier: Apache-2.0
"""A folder of one's own images, and its calibration file."""

from collections.abc import Callable
from pathlib import Path

import pytest

from services.camera.sources.calibration_file import read_calibration
from services.camera.sources.folders.image_folder import ImageFolder
from services.runtime.errors import InputError

CALIBRATION = "fx = 20.0\nfy = 21.0\ncx = 16.0\ncy = 12.0\nwidth = 32\nheight = 24\n"


def test_images_come_in_order_with_their_calibration(image_folder: Path) -> None:
    source = ImageFolder(image_folder)
    assert (source.frame_count, source.rate_hz) == (3, 10.0)
    assert any("assumed at 10 Hz" in note for note in source.notes)
    frames = [source.frame(index) for index in range(4)]
    assert frames[3] is None
    assert [frame.timestamp_ns for frame in frames if frame] == [0, 100_000_000, 200_000_000]
    assert [frame.name for frame in frames if frame] == ["000000", "000001", "000002"]
    assert frames[1] is not None
    assert frames[1].calibration.intrinsics.tolist() == [[20, 0, 16], [0, 21, 12], [0, 0, 1]]
    assert frames[1].calibration.distortion == ()
    assert frames[1].true_pose is None


def test_images_may_lie_one_folder_down(tmp_path: Path, make_images: Callable[..., Path]) -> None:
    make_images("mine/images")
    (tmp_path / "mine" / "calibration.toml").write_text(CALIBRATION)
    assert ImageFolder(tmp_path / "mine").frame_count == 3


def test_times_and_rate_have_an_order(image_folder: Path) -> None:
    (image_folder / "calibration.toml").write_text(CALIBRATION + "rate_hz = 20\n")
    assert ImageFolder(image_folder).rate_hz == 20
    assert ImageFolder(image_folder).notes == ()
    assert ImageFolder(image_folder, rate_hz=25).rate_hz == 25
    (image_folder / "times.txt").write_text("1.0\n1.5\n2.0\n")
    source = ImageFolder(image_folder, rate_hz=25)
    assert source.rate_hz == 2
    frame = source.frame(0)
    assert frame is not None
    assert frame.timestamp_ns == 1_000_000_000


def test_kitti_calibration_serves_too(image_folder: Path) -> None:
    (image_folder / "calibration.toml").unlink()
    (image_folder / "calib.txt").write_text("P0: 20 0 16 0 0 20 12 0 0 0 1 0\n")
    frame = ImageFolder(image_folder).frame(0)
    assert frame is not None
    assert (frame.calibration.width, frame.calibration.intrinsics[1, 1]) == (32, 20)


def test_without_calibration_it_shows_one(image_folder: Path, tmp_path: Path) -> None:
    (image_folder / "calibration.toml").unlink()
    with pytest.raises(InputError, match=r"no calibration: expected .*calibration\.toml.*camera\.calibration.*fx = "):
        ImageFolder(image_folder)
    with pytest.raises(InputError, match=r"elsewhere\.toml: no such file"):
        ImageFolder(image_folder, calibration=tmp_path / "elsewhere.toml")
    (tmp_path / "elsewhere.toml").write_text(CALIBRATION)
    assert ImageFolder(image_folder, calibration=tmp_path / "elsewhere.toml").frame_count == 3


def test_calibration_of_another_size_names_image_and_sizes(image_folder: Path) -> None:
    (image_folder / "calibration.toml").write_text(CALIBRATION.replace("32", "64"))
    with pytest.raises(InputError, match=r"000000\.jpg: 32x24 px, expected 64x24 as in .*calibration\.toml"):
        ImageFolder(image_folder)


@pytest.mark.parametrize("given", ["[0.1, -0.2, 0.001, 0.002]", "[0.1, -0.2, 0.001, 0.002, 0.0]"])
def test_distortion_is_plumb_bob(tmp_path: Path, given: str) -> None:
    path = tmp_path / "calibration.toml"
    path.write_text(f"{CALIBRATION}distortion = {given}\n")
    assert read_calibration(path).distortion == (0.1, -0.2, 0.001, 0.002, 0.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("fx = 1", "no fy, cx, cy, width, height, expected fx = "),
        (CALIBRATION.replace("20.0", "'wide'"), "fx = 'wide', expected a finite number"),
        (CALIBRATION.replace("20.0", "nan"), "fx = nan, expected a finite number"),
        (CALIBRATION.replace("20.0", "-1"), "fx = -1, expected a positive number of px"),
        (CALIBRATION.replace("32", "32.5"), r"width = 32\.5, expected a positive number of px"),
        (CALIBRATION.replace("32", "true"), "width = True, expected a finite number"),
        (f"{CALIBRATION}distortion = [1.0]", r"distortion = \[1\.0\], expected \[k1, k2, p1, p2\]"),
        (f"{CALIBRATION}distortion = 3", "distortion = 3, expected"),
        (f"{CALIBRATION}rate_hz = 0", "rate_hz = 0, expected a positive"),
        (f"{CALIBRATION}skew = 0", "unknown skew"),
        ("fx 1", "not TOML"),
    ],
)
def test_bad_calibration_is_one_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "calibration.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        read_calibration(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
