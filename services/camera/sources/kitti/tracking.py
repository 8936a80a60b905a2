# SPDX-License-Identifier: Apache-2.0
"""A sequence of the KITTI tracking benchmark: training/image_02/0000 with calib/0000.txt and oxts/0000.txt.

label_02 is not read here: it has boxes, and the truth that a frame can carry is masks that know what moves.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.image_files import ImageFiles, list_images
from services.camera.sources.folders.number_rows import ASSUMED_RATE_HZ, even_times_ns, read_lines, rows_of_images
from services.camera.sources.indexed_source import IndexedSource
from services.camera.sources.kitti.extrinsics import KittiValues
from services.camera.sources.kitti.oxts import parse_oxts, world_from_camera
from services.camera.sources.kitti.rectified_pair import KittiPair, NumberedImages, calibrated_pair
from services.runtime.errors import InputError

LEFT, RIGHT = "image_02", "image_03"


def is_tracking_sequence(folder: Path) -> bool:
    """Whether this is a numbered folder of images in a folder named image_02."""
    return folder.resolve().parent.name == LEFT and folder.resolve().name.isdecimal() and bool(list_images(folder))


def sequences_in(folder: Path) -> list[Path]:
    """The sequences of a split's folder (training or testing), or of its image_02."""
    images = folder / LEFT if (folder / LEFT).is_dir() else folder
    if images.resolve().name != LEFT:
        return []
    return sorted(path for path in images.iterdir() if path.is_dir() and path.name.isdecimal())


class KittiTracking(IndexedSource):
    """image_02/0000 (left) and image_03/0000 (right), with calib/0000.txt and oxts/0000.txt two folders up.

    The benchmark gives no times: the images are 10 a second. True poses come from oxts where it is there, as in the
    raw data; their world is the first image's camera 0. Some sequences lack images (0001 lacks four): the numbers in
    the names say which of the oxts' rows, and so which times, are theirs.

    Args:
        folder: the sequence's folder of left images.
        stereo: give the right image too where there is one.
        rate_hz: rate to assume; None is 10.

    Raises:
        InputError: whatever of the sequence cannot be used, by file and line.
    """

    def __init__(self, folder: Path, *, stereo: bool = True, rate_hz: float | None = None) -> None:
        folder = folder.resolve()
        split, sequence = folder.parent.parent, folder.name
        images = ImageFiles(folder)
        right_folder = split / RIGHT / sequence
        right = None
        if stereo and right_folder.is_dir():
            right = NumberedImages(3, right_folder, ImageFiles(right_folder))
        calibration = split / "calib" / f"{sequence}.txt"
        pair = calibrated_pair(calibration, NumberedImages(2, folder, images), right)
        notes = list(pair.notes)
        if rate_hz is None:
            rate_hz = ASSUMED_RATE_HZ
            notes.append(f"KITTI tracking gives no times: they are assumed at {rate_hz:g} Hz")
        oxts = split / "oxts" / f"{sequence}.txt"
        rows = list(range(len(images)))
        truth = None
        if oxts.is_file():
            lines = read_lines(oxts)
            if len(lines) < len(images):
                raise InputError(f"{oxts}: {len(lines)} lines, expected {len(images)}, one for every image")
            rows = rows_of_images(images.paths, len(lines))
            truth = _truth(oxts, [lines[row] for row in rows], calibration, pair)
        else:
            notes.append(f"no true pose: no oxts/{sequence}.txt")
        super().__init__(
            f"KITTI tracking {split.name} {sequence}",
            even_times_ns(rows, rate_hz),
            rate_hz,
            pair.left,
            right=pair.right,
            world_from_camera=truth,
            notes=notes,
        )


def _truth(oxts: Path, lines: list[tuple[int, str]], calibration: Path, pair: KittiPair) -> npt.NDArray[np.float64]:
    rows = np.array([parse_oxts(oxts, *line) for line in lines])
    values = KittiValues(calibration)
    # The benchmark's own files and those of its object sibling spell the names differently.
    velodyne = values.transform("Tr_velo_cam", "Tr_velo_to_cam")
    imu = values.transform("Tr_imu_velo", "Tr_imu_to_velo")
    rectification = values.transform("R_rect", "R0_rect")
    return world_from_camera(rows, rectification @ velodyne @ imu, pair.camera_0_from_camera)
