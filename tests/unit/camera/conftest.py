# SPDX-License-Identifier: Apache-2.0
"""Small inputs on disk, as a user would have them."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

WIDTH, HEIGHT = 32, 24
P0 = "P0: 20 0 16 0 0 20 12 0 0 0 1 0"
CALIBRATION = f"fx = 20.0\nfy = 21.0\ncx = 16.0\ncy = 12.0\nwidth = {WIDTH}\nheight = {HEIGHT}\n"

MakeImages = Callable[..., Path]


@pytest.fixture
def make_images(tmp_path: Path) -> MakeImages:
    """`make_images("image_0", count)` writes grey images whose every pixel is ten times their index."""

    def make(name: str, count: int = 3, *, suffix: str = ".png", size: tuple[int, int] = (WIDTH, HEIGHT)) -> Path:
        folder = tmp_path / name
        folder.mkdir(parents=True, exist_ok=True)
        for index in range(count):
            cv2.imwrite(str(folder / f"{index:06d}{suffix}"), np.full(size[::-1], 10 * index, dtype=np.uint8))
        return folder

    return make


@pytest.fixture
def kitti(tmp_path: Path, make_images: MakeImages) -> Path:
    """A mono KITTI sequence of three frames with times, without poses."""
    make_images("sequences/00/image_0")
    folder = tmp_path / "sequences" / "00"
    (folder / "calib.txt").write_text(f"{P0}\n")
    (folder / "times.txt").write_text("0.0\n0.103600\n2.072e-1\n")
    return folder


@pytest.fixture
def stereo(kitti: Path, make_images: MakeImages) -> Path:
    """The same with a right camera half a metre to the right."""
    make_images("sequences/00/image_1")
    (kitti / "calib.txt").write_text(f"{P0}\nP1: 20 0 16 -10 0 20 12 0 0 0 1 0\n")
    return kitti


@pytest.fixture
def image_folder(tmp_path: Path, make_images: MakeImages) -> Path:
    """A folder of three images with calibration.toml."""
    folder = make_images("mine", suffix=".jpg")
    (folder / "calibration.toml").write_text(CALIBRATION)
    return folder


@pytest.fixture
def video(tmp_path: Path) -> Path:
    """Ten frames at 12.5 Hz with their calibration beside them; frame i is about 20 * i bright."""
    path = tmp_path / "drive.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 12.5, (WIDTH, HEIGHT))
    for index in range(10):
        writer.write(np.full((HEIGHT, WIDTH, 3), 20 * index, dtype=np.uint8))
    writer.release()
    (tmp_path / "drive.toml").write_text(CALIBRATION)
    return path
