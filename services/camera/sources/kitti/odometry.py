# SPDX-License-Identifier: Apache-2.0
"""A sequence of the KITTI odometry benchmark, or a folder laid out like one."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.image_files import ImageFiles
from services.camera.sources.folders.number_rows import parse_numbers, read_lines, rows_of_images, times_of_folder
from services.camera.sources.indexed_source import IndexedSource
from services.camera.sources.kitti.rectified_pair import LEFT_NUMBERS, NumberedImages, calibrated_pair
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


def is_kitti_folder(folder: Path) -> bool:
    """Whether there is a left camera's image folder, image_0 or image_2."""
    return any((folder / f"image_{number}").is_dir() for number in LEFT_NUMBERS)


class KittiOdometry(IndexedSource):
    """image_0 or image_2 (left), image_1 or image_3 (right), calib.txt, times.txt and poses as far as they are there.

    Poses are looked for as poses.txt in the folder and as ../../poses/<folder's name>.txt; their world is the first
    pose of camera 0 (x right, y down, z forward), and they are given for the camera whose images are used. Where images
    are missing, the numbers in their names say which of the times and poses are theirs.

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
        images = ImageFiles(folder / f"image_{number}")
        right = None
        if stereo and (folder / f"image_{number + 1}").is_dir():
            right = _numbered(folder, number + 1, ImageFiles(folder / f"image_{number + 1}"))
        pair = calibrated_pair(folder / "calib.txt", _numbered(folder, number, images), right)
        times_ns, rate_hz, notes = times_of_folder(folder, images.paths, rate_hz)
        super().__init__(
            f"KITTI {folder.resolve().name}, image_{number}",
            times_ns,
            rate_hz,
            pair.left,
            right=pair.right,
            world_from_camera=_read_truth(folder, images.paths, times_ns, pair.camera_0_from_camera),
            notes=(*pair.notes, *notes),
        )


def _numbered(folder: Path, number: int, images: ImageFiles) -> NumberedImages:
    return NumberedImages(number, folder / f"image_{number}", images)


def _read_truth(
    folder: Path, images: Sequence[Path], times_ns: Sequence[int], camera_0_from_camera: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64] | None:
    for path in (folder / "poses.txt", folder.resolve().parent.parent / "poses" / f"{folder.resolve().name}.txt"):
        if path.is_file():
            # A trajectory takes nothing but rigid poses.
            path_of_camera_0 = Trajectory(np.array(times_ns), _read_poses(path, images), str(path))
            return path_of_camera_0.world_from_camera @ camera_0_from_camera
    return None


def _read_poses(path: Path, images: Sequence[Path]) -> npt.NDArray[np.float64]:
    """(N, 4, 4) world_from_camera 0 of each image: 12 numbers a line, [R | t] by rows, metres."""
    lines = read_lines(path)
    if len(lines) < len(images):
        raise InputError(f"{path}: {len(lines)} poses, expected {len(images)}, one for every image")
    poses = np.tile(np.eye(4), (len(images), 1, 1))
    for pose, row in zip(poses, rows_of_images(images, len(lines)), strict=True):
        pose[:3] = np.reshape(parse_numbers(path, *lines[row], 12), (3, 4))
    return poses
