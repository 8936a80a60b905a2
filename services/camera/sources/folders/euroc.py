# SPDX-License-Identifier: Apache-2.0
"""A sequence of the EuRoC MAV data sets (ASL format), or a folder laid out like one.

Source: Burri et al., "The EuRoC micro aerial vehicle datasets", IJRR 2016.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.euroc_sensor import EurocCamera, read_camera
from services.camera.sources.folders.image_files import ListedImages
from services.camera.sources.folders.number_rows import rate_of, read_lines
from services.camera.sources.folders.rectification import rectify
from services.camera.sources.indexed_source import CameraImages, IndexedSource
from services.camera.sources.true_path import note_of_missing, poses_at
from services.formats.euroc import read_euroc
from services.runtime.errors import InputError

_INNER = "mav0"
_TRUTH = Path("state_groundtruth_estimate0") / "data.csv"


def is_euroc_folder(folder: Path) -> bool:
    """Whether there is a cam0 with its list of images, here or in mav0."""
    return (_sequence(folder) / "cam0" / "data.csv").is_file()


class Euroc(IndexedSource):
    """cam0 (left), cam1 (right), each data.csv, data/ and sensor.yaml, and state_groundtruth_estimate0/data.csv.

    A pair is rectified on loading, and the true pose is the rectified left camera's; images of one camera stay as
    they are and the calibration tells their distortion. Frames that only one camera has are left out of a pair.

    Args:
        folder: the sequence's folder, or the mav0 in it.
        stereo: give the right image too where there is a cam1.
        rectify_stereo: without, a pair is no pair: the left images are given as they are, alone.

    Raises:
        InputError: whatever of the folder cannot be used, by file and line.
    """

    def __init__(self, folder: Path, *, stereo: bool = True, rectify_stereo: bool = True) -> None:
        root = _sequence(folder)
        left_files = _read_listing(root / "cam0")
        left_sensor = read_camera(root / "cam0" / "sensor.yaml")
        notes: list[str] = []
        is_pair = stereo and rectify_stereo and (root / "cam1" / "data.csv").is_file()
        times_ns = sorted(left_files)
        right_files = _read_listing(root / "cam1") if is_pair else {}
        if is_pair:
            times_ns = sorted(left_files.keys() & right_files.keys())
            if not times_ns:
                raise InputError(f"{root}: no image of cam0 has one of cam1 at its time, expected pairs")
            if len(times_ns) < len(left_files):
                notes.append(f"{len(left_files) - len(times_ns)} images of cam0 have none of cam1 and are left out")
        elif stereo and (root / "cam1").is_dir():
            notes.append("cam1 is not used: without rectification there is no pair")
        left = _camera_images(root / "cam0", left_sensor, [left_files[time_ns] for time_ns in times_ns])
        right = None
        body_from_camera = left_sensor.body_from_camera
        if is_pair:
            right_sensor = read_camera(root / "cam1" / "sensor.yaml")
            right = _camera_images(root / "cam1", right_sensor, [right_files[time_ns] for time_ns in times_ns])
            right_from_left = np.linalg.inv(right_sensor.body_from_camera) @ body_from_camera
            _expect_one_size(root, left, right)
            pair = rectify(left, right, right_from_left, str(root / "cam1"))
            left, right = pair.left, pair.right
            body_from_camera = body_from_camera @ pair.camera_from_rectified
        poses = _read_truth(root, body_from_camera, times_ns)
        super().__init__(
            f"EuRoC {(root.resolve().parent if root.resolve().name == _INNER else root.resolve()).name}",
            times_ns,
            rate_of(times_ns, left_sensor.rate_hz),
            left,
            right=right,
            world_from_camera=poses,
            notes=[*notes, *note_of_missing(poses or [])],
        )


def _sequence(folder: Path) -> Path:
    return folder / _INNER if (folder / _INNER).is_dir() else folder


def _read_listing(camera: Path) -> dict[int, Path]:
    path = camera / "data.csv"
    files: dict[int, Path] = {}
    for line_number, line in read_lines(path):
        time, _, name = (field.strip() for field in line.partition(","))
        if not (time.isdecimal() and int(time) < 2**63 and name):
            raise InputError(f"{path} line {line_number}: {line!r}, expected a time in nanoseconds and a file's name")
        if files and int(time) <= next(reversed(files)):
            raise InputError(f"{path} line {line_number}: time {time} ns, expected times that increase")
        files[int(time)] = camera / "data" / name
    if not files:
        raise InputError(f"{path}: no images listed, expected lines of a time in nanoseconds and a file's name")
    return files


def _camera_images(folder: Path, sensor: EurocCamera, paths: list[Path]) -> CameraImages:
    images = ListedImages(paths)
    if images.size != sensor.size:
        raise InputError(
            f"image {paths[0]}: {'x'.join(map(str, images.size))} px, "
            f"expected {'x'.join(map(str, sensor.size))} as in {folder / 'sensor.yaml'}"
        )
    return CameraImages(images, sensor.record())


def _expect_one_size(root: Path, left: CameraImages, right: CameraImages) -> None:
    if left.images.size != right.images.size:
        raise InputError(
            f"{root / 'cam1'}: images of {'x'.join(map(str, right.images.size))} px, "
            f"expected {'x'.join(map(str, left.images.size))} as in cam0"
        )


def _read_truth(
    root: Path, body_from_camera: npt.NDArray[np.float64], times_ns: list[int]
) -> list[npt.NDArray[np.float64] | None] | None:
    if not (root / _TRUTH).is_file():
        return None
    return poses_at(read_euroc(root / _TRUTH, body_from_camera), times_ns)
