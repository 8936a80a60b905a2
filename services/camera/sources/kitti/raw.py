# SPDX-License-Identifier: Apache-2.0
"""A synchronised, rectified drive of the KITTI raw data: <date>/<date>_drive_0001_sync.

Source: Geiger et al., "Vision meets Robotics: The KITTI Dataset", IJRR 2013, and the raw data development kit.
"""

import re
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.image_files import ImageFiles
from services.camera.sources.folders.number_rows import ASSUMED_RATE_HZ, NS_PER_S, rate_of, read_lines
from services.camera.sources.indexed_source import IndexedSource
from services.camera.sources.kitti.extrinsics import KittiValues
from services.camera.sources.kitti.oxts import parse_oxts, world_from_camera
from services.camera.sources.kitti.rectified_pair import LEFT_NUMBERS, KittiPair, NumberedImages, calibrated_pair
from services.runtime.errors import InputError

CALIBRATION = "calib_cam_to_cam.txt"
_EXTRINSICS = ("calib_velo_to_cam.txt", "calib_imu_to_velo.txt")
_TIME = re.compile(r"(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d)(?:\.(\d{1,9}))?")


def is_kitti_drive(folder: Path) -> bool:
    """Whether there is a left camera's image_00/data or image_02/data."""
    return any((folder / f"image_0{number}" / "data").is_dir() for number in LEFT_NUMBERS)


def drives_in(folder: Path) -> list[Path]:
    """The drives of a date's folder."""
    return sorted(path for path in folder.iterdir() if path.is_dir() and is_kitti_drive(path))


class KittiRaw(IndexedSource):
    """image_02 or image_00 (left), image_03 or image_01 (right), timestamps.txt, oxts and the date's calibration.

    Times are the left camera's, read as UTC. True poses come from oxts where it and calib_velo_to_cam.txt and
    calib_imu_to_velo.txt are there; their world is the first frame's camera 0. The numbers in the images' names are
    those of the lines of timestamps.txt and of the files of oxts, so that a part of a drive can be used.

    Args:
        folder: the drive's folder, or one with the calibration files in it.
        left: "image_0" or "image_2"; None takes the colour images where there are some.
        stereo: give the right image too where there is one.

    Raises:
        InputError: whatever of the folder cannot be used, by file and line.
    """

    def __init__(self, folder: Path, *, left: str | None = None, stereo: bool = True) -> None:
        number = next((n for n in LEFT_NUMBERS if (folder / f"image_0{n}" / "data").is_dir()), 0)
        if left is not None:
            number = int(left[-1])
        left_images, files = _numbered(folder, number)
        right = None
        if stereo and (folder / f"image_0{number + 1}" / "data").is_dir():
            right, _ = _numbered(folder, number + 1)
        date = folder if (folder / CALIBRATION).is_file() else folder.resolve().parent
        pair = calibrated_pair(date / CALIBRATION, left_images, right)
        _expect_rectified(date / CALIBRATION, left_images)
        indices = [_index_of(path) for path in files.paths]
        times_ns = _read_times_ns(folder / f"image_0{number}" / "timestamps.txt", indices)
        notes = list(pair.notes)
        super().__init__(
            f"KITTI raw {folder.resolve().name}, image_0{number}",
            times_ns,
            rate_of(times_ns, ASSUMED_RATE_HZ),
            pair.left,
            right=pair.right,
            world_from_camera=_read_truth(folder, date, indices, pair, notes),
            notes=notes,
        )


def _numbered(folder: Path, number: int) -> tuple[NumberedImages, ImageFiles]:
    files = ImageFiles(folder / f"image_0{number}" / "data")
    return NumberedImages(number, folder / f"image_0{number}", files), files


def _expect_rectified(calibration: Path, left: NumberedImages) -> None:
    """The drives named _extract hold images as they were taken, larger than the rectified ones."""
    width, height = KittiValues(calibration).numbers(f"S_rect_0{left.number}", 2)
    if left.images.size != (width, height):
        raise InputError(
            f"{left.folder}: images of {'x'.join(map(str, left.images.size))} px, expected the {width:g}x{height:g} px "
            f"of {calibration.name}'s S_rect_0{left.number}: a drive named _sync, rectified"
        )


def _index_of(path: Path) -> int:
    if not path.stem.isdecimal():
        raise InputError(f"image {path}: expected a number as its name, such as 0000000000.png")
    return int(path.stem)


def _read_times_ns(path: Path, indices: list[int]) -> list[int]:
    lines = read_lines(path)
    if indices[-1] >= len(lines):
        raise InputError(f"{path}: {len(lines)} times, expected one for image {indices[-1]:010d}")
    times_ns: list[int] = []
    for index in indices:
        line_number, line = lines[index]
        time_ns = _parse_date_ns(path, line_number, line)
        if time_ns <= (times_ns[-1] if times_ns else -1):
            raise InputError(f"{path} line {line_number}: time {line}, expected times that increase from 1970")
        times_ns.append(time_ns)
    return times_ns


def _parse_date_ns(path: Path, line_number: int, line: str) -> int:
    found = _TIME.fullmatch(line)
    try:
        if found is None:
            raise ValueError
        moment = datetime.strptime(found[1], "%Y-%m-%d %H:%M:%S").replace(tzinfo=UTC)
    except ValueError:
        raise InputError(
            f"{path} line {line_number}: {line!r}, expected such as 2011-09-26 13:02:25.964389445"
        ) from None
    return int(moment.timestamp()) * NS_PER_S + int((found[2] or "0").ljust(9, "0"))


def _read_truth(
    folder: Path, date: Path, indices: list[int], pair: KittiPair, notes: list[str]
) -> npt.NDArray[np.float64] | None:
    missing = [path for path in (*(date / name for name in _EXTRINSICS), folder / "oxts" / "data") if not path.exists()]
    if missing:
        notes.append(f"no true pose: no {', '.join(path.name for path in missing)}")
        return None
    velodyne, imu = (KittiValues(date / name).rotation_and_translation() for name in _EXTRINSICS)
    rectification = KittiValues(date / CALIBRATION).transform("R_rect_00")
    rows = [_read_oxts(folder / "oxts" / "data" / f"{index:010d}.txt") for index in indices]
    return world_from_camera(np.array(rows), rectification @ velodyne @ imu, pair.camera_0_from_camera)


def _read_oxts(path: Path) -> list[float]:
    lines = read_lines(path)
    if len(lines) != 1:
        raise InputError(f"{path}: {len(lines)} lines, expected one")
    return parse_oxts(path, *lines[0])
