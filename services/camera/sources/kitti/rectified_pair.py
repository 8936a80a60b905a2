# SPDX-License-Identifier: Apache-2.0
"""The rectified camera, or pair of cameras, that KITTI's projection matrices describe."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration
from services.camera.sources.indexed_source import CameraImages, Images
from services.camera.sources.kitti.calibration import camera_0_from, read_projections
from services.runtime.errors import InputError

# Colour first: the networks behind the camera were trained on it.
LEFT_NUMBERS = (2, 0)
Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class NumberedImages:
    """The images of KITTI's camera `number` (0 and 2 are left, 1 and 3 right) in `folder`."""

    number: int
    folder: Path
    images: Images


@dataclass(frozen=True)
class KittiPair:
    """The cameras in use; the left one is where the pair's own frame is."""

    left: CameraImages
    right: CameraImages | None
    camera_0_from_camera: Array
    """(4, 4), metres; from the left camera in use to rectified camera 0"""
    notes: tuple[str, ...]


def calibrated_pair(path: Path, left: NumberedImages, right: NumberedImages | None) -> KittiPair:
    """The projections of `path` (calib.txt or calib_cam_to_cam.txt) for the images in use.

    Raises:
        InputError: no such file, no projection for a pair's images, or images that do not fit together.
    """
    projections = read_projections(path)
    notes: list[str] = []
    left_projection = projections.get(f"P{left.number}")
    if left_projection is None:
        if right is not None:
            raise InputError(f"{path}: no line 'P{left.number}:', expected one for the stereo images in {left.folder}")
        found, left_projection = next(iter(projections.items()))
        notes.append(f"{path.name} has no P{left.number}: {found} is taken for the images in {left.folder.name}")
    own = np.hstack((left_projection[:, :3], np.zeros((3, 1))))
    return KittiPair(
        CameraImages(left.images, _calibration(left.images, own, "camera")),
        None if right is None else _right_of(path, left, left_projection, right, projections),
        camera_0_from(left_projection),
        tuple(notes),
    )


def _right_of(
    path: Path, left: NumberedImages, left_projection: Array, right: NumberedImages, projections: dict[str, Array]
) -> CameraImages:
    if len(right.images) != len(left.images):
        raise InputError(f"{right.folder}: {len(right.images)} images, expected {len(left.images)}")
    if right.images.size != left.images.size:
        raise InputError(
            f"{right.folder}: images of {'x'.join(map(str, right.images.size))} px, "
            f"expected {'x'.join(map(str, left.images.size))} as in {left.folder.name}"
        )
    if f"P{right.number}" not in projections:
        raise InputError(f"{path}: no line 'P{right.number}:', expected one for the stereo images in {right.folder}")
    projection = projections[f"P{right.number}"].copy()
    projection[:, 3] -= left_projection[:, 3]
    return CameraImages(right.images, _calibration(right.images, projection, "camera_right"))


def _calibration(images: Images, projection: Array, frame_id: str) -> CameraCalibration:
    return CameraCalibration(0, *images.size, projection[:, :3].copy(), projection=projection.copy(), frame_id=frame_id)
