# SPDX-License-Identifier: Apache-2.0
"""A recording's calibration message as a camera's calibration."""

import re

import numpy as np

from schemas.records import CameraCalibration
from services.camera.sources.recordings.message_log import CameraInfo
from services.camera.sources.recordings.message_topics import ChosenTopics
from services.runtime.errors import InputError

# plumb_bob's five are the first five of the rational model's eight.
_MODELS = ("plumb_bob", "rational_polynomial", "")
_COEFFICIENTS = 5
# image_rect, image_rect_color, rectified; not direct.
_RECTIFIED = re.compile(r"(?:^|_)rect")


def calibration_of(
    info: CameraInfo, topics: ChosenTopics, size: tuple[int, int], recording: str, notes: list[str]
) -> CameraCalibration:
    """The camera of the images, whose (width, height) is `size`; its time does not count.

    Images whose topic is called rectified are a camera without distortion, as ROS's image_proc makes them.

    Raises:
        InputError: another size, no focal length, no pinhole camera's matrix, or a distortion that is not plumb_bob.
    """
    where = f"{recording} {topics.info}"
    if (info.width, info.height) != size:
        raise InputError(f"{where}: {info.width}x{info.height} px, expected {size[0]}x{size[1]} as the images")
    distortion: tuple[float, ...] = ()
    if any(_RECTIFIED.search(part) for part in topics.image.split("/")[-2:]):
        notes.append(f"{topics.image} is taken as rectified by its name: the calibration's projection is used")
        intrinsics = info.projection[:, :3]
    else:
        intrinsics, distortion = info.intrinsics, _plumb_bob(info, where)
    if not (np.isfinite(intrinsics).all() and intrinsics[0, 0] > 0 and intrinsics[1, 1] > 0):
        focal = f"{intrinsics[0, 0]:g} and {intrinsics[1, 1]:g}"
        raise InputError(f"{where}: focal lengths {focal} px, expected a calibrated camera's, or camera.calibration")
    if intrinsics[2].tolist() != [0.0, 0.0, 1.0]:
        raise InputError(f"{where}: last row of K {intrinsics[2].tolist()}, expected 0 0 1, or camera.calibration")
    return CameraCalibration(0, *size, np.ascontiguousarray(intrinsics), distortion)


def _plumb_bob(info: CameraInfo, where: str) -> tuple[float, ...]:
    if not any(info.distortion):
        return ()
    if not np.isfinite(info.distortion).all():
        raise InputError(f"{where}: distortion {info.distortion}, expected finite numbers, or camera.calibration")
    if info.distortion_model not in _MODELS or any(info.distortion[_COEFFICIENTS:]):
        raise InputError(
            f"{where}: distortion {info.distortion_model!r} of {len(info.distortion)} coefficients, "
            "expected plumb_bob's k1 k2 p1 p2 k3, or camera.calibration"
        )
    return (*info.distortion, *(0.0,) * _COEFFICIENTS)[:_COEFFICIENTS]
