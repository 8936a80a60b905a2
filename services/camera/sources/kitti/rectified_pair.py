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
    _expect_partners(left, right)
    if right.images.size != left.images.size:
        raise InputError(
            f"{right.folder}: images of {'x'.join(map(str, right.images.size))} px, "
            f"expected {'x'.join(map(str, left.images.size))} as in {left.folder.name}"
        )
    if f"P{right.number}" not in projections:
        raise InputError(f"{path}: no line 'P{right.number}:', expected one for the stereo images in {right.folder}")
    projection = projections[f"P{right.number}"].copy()
    if not np.allclose(projection[:, :3], left_projection[:, :3]):
        raise InputError(
            f"{path}: P{left.number} and P{right.number} differ in their first three columns, expected a rectified pair"
        )
    projection[:, 3] -= left_projection[:, 3]
    if not projection[0, 3] < 0:
        baseline_m = 0.0 - projection[0, 3] / projection[0, 0]
        raise InputError(
            f"{path}: camera {right.number} at {baseline_m:g} m to the right of camera {left.number}, expected above 0"
        )
    return CameraImages(right.images, _calibration(right.images, projection, "camera_right"))


def _expect_partners(left: NumberedImages, right: NumberedImages) -> None:
    """Every image has one of the same name on the other side."""
    lefts, rights = ([side.images.name(index) for index in range(len(side.images))] for side in (left, right))
    if lefts == rights:
        return
    for ours, names, theirs in ((left, set(rights), lefts), (right, set(lefts), rights)):
        alone = [name for name in theirs if name not in names]
        if alone:
            other = right if ours is left else left
            raise InputError(f"{other.folder}: no {alone[0]}, expected one for every image in {ours.folder}")


def _calibration(images: Images, projection: Array, frame_id: str) -> CameraCalibration:
    return CameraCalibration(0, *images.size, projection[:, :3].copy(), projection=projection.copy(), frame_id=frame_id)
