# SPDX-License-Identifier: Apache-2.0
"""A calibrated stereo pair made rectified: both cameras looking the same way, rows matching rows.

Source: OpenCV's stereoRectify (Bouguet's method), which keeps only what both cameras see of the scene.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration
from services.camera.sources.indexed_source import CameraImages, Images
from services.runtime.errors import InputError

Array = npt.NDArray[np.float64]

# Rectified images keep what both cameras see; from a tenth of the image on nothing is won by a pair.
_MOST_ZOOM = 10.0
_LEAST_BASELINE_M = 1e-4


class RectifiedImages:
    """`images` as a rectified camera would have taken them.

    Args:
        images: as the sensor gave them.
        calibration: of that sensor.
        rectified_from_camera: (3, 3) rotation.
        intrinsics: (3, 3) of the rectified camera, px.
    """

    def __init__(
        self, images: Images, calibration: CameraCalibration, rectified_from_camera: Array, intrinsics: Array
    ) -> None:
        self._images = images
        self.size = images.size
        self._map_x, self._map_y = cv2.initUndistortRectifyMap(
            calibration.intrinsics,
            np.array(calibration.distortion),
            rectified_from_camera,
            intrinsics,
            images.size,
            cv2.CV_16SC2,
        )

    def __len__(self) -> int:
        return len(self._images)

    def name(self, index: int) -> str:
        return self._images.name(index)

    def read(self, index: int) -> npt.NDArray[np.uint8]:
        pixels = cv2.remap(self._images.read(index), self._map_x, self._map_y, cv2.INTER_LINEAR)
        return np.asarray(pixels, dtype=np.uint8)


@dataclass(frozen=True)
class RectifiedStereo:
    """Both cameras, and (4, 4) camera_from_rectified of the left one: a pure rotation."""

    left: CameraImages
    right: CameraImages
    camera_from_rectified: Array


def rectify(left: CameraImages, right: CameraImages, right_from_left: Array, where: str) -> RectifiedStereo:
    """The rectified pair; `right_from_left` is (4, 4) in metres between the cameras as they are, `where` names them.

    Raises:
        InputError: the right camera is not right of the left one, or nothing is left of the images.
    """
    size = left.images.size
    if not np.linalg.norm(right_from_left[:3, 3]) > _LEAST_BASELINE_M:
        raise InputError(f"{where}: where the left camera is, expected right of it")
    left_rotation, right_rotation, left_projection, right_projection, *_ = cv2.stereoRectify(
        left.calibration.intrinsics,
        np.array(left.calibration.distortion),
        right.calibration.intrinsics,
        np.array(right.calibration.distortion),
        size,
        np.ascontiguousarray(right_from_left[:3, :3]),
        np.ascontiguousarray(right_from_left[:3, 3:]),
        flags=cv2.CALIB_ZERO_DISPARITY,
        alpha=0,
    )
    if not right_projection[0, 3] < 0:
        x, y, z = np.linalg.inv(right_from_left)[:3, 3]
        raise InputError(f"{where}: at x {x:.3f}, y {y:.3f}, z {z:.3f} m of the left camera, expected right of it")
    focal_px, rectified_px = left.calibration.intrinsics[0, 0], left_projection[0, 0]
    if not focal_px / _MOST_ZOOM < rectified_px < focal_px * _MOST_ZOOM:
        raise InputError(
            f"{where}: rectified with the left one, a focal length of {rectified_px:.4g} px instead of {focal_px:.4g}; "
            "expected two cameras that see the same, with the distortion of their lenses"
        )
    camera_from_rectified = np.eye(4)
    camera_from_rectified[:3, :3] = left_rotation.T
    return RectifiedStereo(
        _rectified(left, left_rotation, left_projection, "camera"),
        _rectified(right, right_rotation, right_projection, "camera_right"),
        camera_from_rectified,
    )


def _rectified(camera: CameraImages, rotation: Any, projection: Any, frame_id: str) -> CameraImages:
    intrinsics = np.ascontiguousarray(projection[:, :3])
    images = RectifiedImages(camera.images, camera.calibration, rotation, intrinsics)
    calibration = CameraCalibration(0, *images.size, intrinsics, projection=projection, frame_id=frame_id)
    return CameraImages(images, calibration)
