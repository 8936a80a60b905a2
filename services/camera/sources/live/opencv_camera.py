# SPDX-License-Identifier: Apache-2.0
"""Live cameras that OpenCV opens: video devices by V4L2, streams (RTSP, HTTP) by FFmpeg."""

import math
from pathlib import Path

import cv2
import numpy as np

from schemas.records import CameraCalibration
from services.camera.sources.calibration_file import find_calibration, read_calibration
from services.camera.sources.live.live_address import device_number, without_credentials
from services.camera.sources.live.live_camera import STREAM_TIMEOUT_MS, Capture, LiveCamera
from services.camera.sources.opencv_log import silence_opencv

ASSUMED_FIELD_OF_VIEW_DEG = 60.0
"""horizontally, of a camera whose calibration nobody gave"""


def open_live_camera(given: str, *, calibration: Path | None = None) -> LiveCamera:
    """The camera at an address that `is_live`. Without a calibration file its field of view is assumed.

    Raises:
        InputError: it cannot be opened, or the calibration cannot be used.
    """
    name = f"camera {without_credentials(given)}"
    if calibration is None:
        note = (
            f"no calibration: a horizontal field of view of {ASSUMED_FIELD_OF_VIEW_DEG:g} degrees is assumed, without "
            "distortion; camera.calibration names a file that knows better"
        )
        return LiveCamera(name, lambda: _open_capture(given), assumed_calibration, notes=(note,))
    model = read_calibration(find_calibration(calibration))
    return LiveCamera(name, lambda: _open_capture(given), lambda size: model.for_images(size, Path(name)).record(0))


def assumed_calibration(size: tuple[int, int]) -> CameraCalibration:
    """A pinhole camera of the assumed field of view, looking through the middle of its images."""
    width, height = size
    focal_px = width / 2 / math.tan(math.radians(ASSUMED_FIELD_OF_VIEW_DEG) / 2)
    intrinsics = np.array([[focal_px, 0.0, width / 2], [0.0, focal_px, height / 2], [0.0, 0.0, 1.0]])
    return CameraCalibration(0, width, height, intrinsics)


def _open_capture(given: str) -> Capture | None:
    silence_opencv()
    number = device_number(given)
    if number is not None:
        capture = cv2.VideoCapture(number, cv2.CAP_V4L2)
        # The driver would keep frames that are old when they are asked for.
        capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    else:
        timeouts = (cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, cv2.CAP_PROP_READ_TIMEOUT_MSEC)
        capture = cv2.VideoCapture(
            given, cv2.CAP_FFMPEG, [value for option in timeouts for value in (option, STREAM_TIMEOUT_MS)]
        )
    if capture.isOpened():
        return capture
    capture.release()
    return None
