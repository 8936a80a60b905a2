# SPDX-License-Identifier: Apache-2.0
"""A sequence of the KITTI odometry benchmark, or a folder laid out like one."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.image_files import ImageFiles
from services.camera.sources.folders.number_rows import read_kitti_poses, times_of_folder
from services.camera.sources.indexed_source import IndexedSource
from services.camera.sources.kitti.rectified_pair import LEFT_NUMBERS, NumberedImages, calibrated_pair


def is_kitti_folder(folder: Path) -> bool:
    """Whether there is a left camera's image folder, image_0 or image_2."""
    return any((folder / f"image_{number}").is_dir() for number in LEFT_NUMBERS)


class KittiOdometry(IndexedSource):
    """image_0 or image_2 (left), image_1 or image_3 (right), calib.txt, times.txt and poses as far as they are there.

    Poses are looked for as poses.txt in the folder and as ../../poses/<folder's name>.txt; their world is the first
    pose of camera 0 (x right, y down, z forward), and they are given for the camera whose images are used.

    Args:
        folder: the sequence's folder, e.g. sequences/03.
        left: "image_0" or "image_2"; None takes the colour images where there are some.
        stereo: give the right image too where there is one.
        rate_hz: rate to assume without times.txt; None is 10.

    Raises:
        InputError: whatever of the folder cannot be used, by file and line.
    """

    def __init__(
        self, folder: Path, *, left: str | None = None, stereo: bool = True, rate_hz: float | None = None
    ) -> None:
        number = next((n for n in LEFT_NUMBERS if (folder / f"image_{n}").is_dir()), 0)
        if left is not None:
            number = int(left[-1])
        left_images = _numbered(folder, number)
        right = folder / f"image_{number + 1}"
        pair = calibrated_pair(
            folder / "calib.txt", left_images, _numbered(folder, number + 1) if stereo and right.is_dir() else None
        )
        times_ns, rate_hz, notes = times_of_folder(folder, len(left_images.images), rate_hz)
        super().__init__(
            f"KITTI {folder.resolve().name}, image_{number}",
            times_ns,
            rate_hz,
            pair.left,
            right=pair.right,
            world_from_camera=_read_poses(folder, len(times_ns), pair.camera_0_from_camera),
            notes=(*pair.notes, *notes),
        )


def _numbered(folder: Path, number: int) -> NumberedImages:
    images = folder / f"image_{number}"
    return NumberedImages(number, images, ImageFiles(images))


def _read_poses(
    folder: Path, frames: int, camera_0_from_camera: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64] | None:
    for path in (folder / "poses.txt", folder.resolve().parent.parent / "poses" / f"{folder.resolve().name}.txt"):
        if path.is_file():
            return read_kitti_poses(path, frames) @ camera_0_from_camera
    return None
