# SPDX-License-Identifier: Apache-2.0
"""A camera's sensor.yaml of the EuRoC MAV data sets.

The file is YAML of one level with flow lists, read here by its keys: no YAML library is needed for six of them, and
OpenCV's reader wants a first line that EuRoC's files lack.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration
from services.formats.euroc import read_body_from_sensor
from services.runtime.errors import InputError

_KEYS = ("rate_hz", "resolution", "camera_model", "intrinsics", "distortion_model", "distortion_coefficients")
_MODELS = ("radial-tangential", "radtan", "plumb_bob")
_COUNTS = {"rate_hz": (1,), "resolution": (2,), "intrinsics": (4,), "distortion_coefficients": (4, 5)}


@dataclass(frozen=True)
class EurocCamera:
    """A pinhole camera on a body; `distortion` is k1 k2 p1 p2 k3 (OpenCV's)."""

    size: tuple[int, int]
    """(width, height) in px"""
    intrinsics: npt.NDArray[np.float64]
    """(3, 3), px"""
    distortion: tuple[float, ...]
    body_from_camera: npt.NDArray[np.float64]
    """(4, 4), metres; the camera frame is optical"""
    rate_hz: float

    def record(self) -> CameraCalibration:
        """The calibration of images as they are, distorted; its time does not count."""
        return CameraCalibration(0, *self.size, self.intrinsics, self.distortion)


def read_camera(path: Path) -> EurocCamera:
    """The camera of `path`.

    Raises:
        InputError: not there, a key missing, a list of another length, or a model other than pinhole with
            radial-tangential distortion; names the file, the key, found and expected.
    """
    body_from_camera = read_body_from_sensor(path)
    # A list may go over several lines.
    text = re.sub(r"\[[^\]]*\]", lambda found: found[0].replace("\n", " "), path.read_text(encoding="utf-8"))
    values = dict(re.findall(rf"^({'|'.join(_KEYS)})\s*:\s*([^#\n]*)", text, re.MULTILINE))
    missing = [key for key in _KEYS if key not in values]
    if missing:
        raise InputError(f"{path}: no {', '.join(missing)}, expected a camera's sensor.yaml of EuRoC")
    for key, known in (("camera_model", ("pinhole",)), ("distortion_model", _MODELS)):
        if values[key].strip() not in known:
            raise InputError(f"{path}: {key} '{values[key].strip()}', expected {known[0]}")
    width, height = _numbers(path, "resolution", values["resolution"])
    fx, fy, cx, cy = _numbers(path, "intrinsics", values["intrinsics"])
    if min(width, height, fx, fy) <= 0:
        raise InputError(f"{path}: resolution {width:g}x{height:g}, focal lengths {fx:g} {fy:g}, expected above 0")
    rate_hz = _numbers(path, "rate_hz", values["rate_hz"])[0]
    if rate_hz <= 0:
        raise InputError(f"{path}: rate_hz {rate_hz:g}, expected above 0")
    distortion = _numbers(path, "distortion_coefficients", values["distortion_coefficients"])
    return EurocCamera(
        (int(width), int(height)),
        np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]),
        (*distortion, *(0.0,) * (5 - len(distortion))),
        body_from_camera,
        rate_hz,
    )


def _numbers(path: Path, key: str, text: str) -> list[float]:
    fields = text.strip().strip("[]").replace(",", " ").split()
    try:
        numbers = [float(field) for field in fields]
    except ValueError:
        numbers = []
    if len(numbers) not in _COUNTS[key] or not np.isfinite(numbers).all():
        counts = " or ".join(map(str, _COUNTS[key]))
        raise InputError(f"{path}: {key} {text.strip()!r}, expected {counts} finite numbers")
    return numbers
