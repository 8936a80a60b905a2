# SPDX-License-Identifier: Apache-2.0
"""One camera's calibration from a file of the user's: kinemap's small TOML, or KITTI's calib.txt."""

import math
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from schemas.records import CameraCalibration
from services.camera.sources.kitti.calibration import read_projections
from services.runtime.errors import InputError

CALIBRATION_NAMES = ("calibration.toml", "calib.txt")
EXAMPLE = (
    "fx = 721.5, fy = 721.5, cx = 609.6, cy = 172.9, width = 1242, height = 375, distortion = [k1, k2, p1, p2, k3] "
    "(one key a line; distortion may be left out)"
)
_REQUIRED = ("fx", "fy", "cx", "cy", "width", "height")
_OPTIONAL = ("distortion", "rate_hz")


@dataclass(frozen=True)
class CameraModel:
    """A pinhole camera in px; `distortion` k1 k2 p1 p2 k3 (OpenCV's), empty where the image is rectified."""

    path: Path
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    size: tuple[int, int] | None
    """(width, height); None where the file does not say"""
    distortion: tuple[float, ...] = ()
    rate_hz: float | None = None

    def for_images(self, size: tuple[int, int], example: Path) -> "CameraModel":
        """This camera, held against the images' (width, height). Raises InputError when its own size is another."""
        if self.size is not None and self.size != size:
            raise InputError(
                f"image {example}: {size[0]}x{size[1]} px, expected {self.size[0]}x{self.size[1]} as in {self.path}"
            )
        return replace(self, size=size)

    def record(self, timestamp_ns: int) -> CameraCalibration:
        """The calibration as a message under a frame's time."""
        if self.size is None:
            raise ValueError(f"calibration {self.path} was not held against its images")
        intrinsics = np.array(
            [[self.fx_px, 0.0, self.cx_px], [0.0, self.fy_px, self.cy_px], [0.0, 0.0, 1.0]], dtype=np.float64
        )
        return CameraCalibration(timestamp_ns, *self.size, intrinsics, self.distortion)


def find_calibration(given: Path | None, *places: Path) -> Path:
    """The file that was given, or the first of `places` that is there.

    Raises:
        InputError: there is none; says where it was looked for, and what such a file looks like.
    """
    if given is not None:
        if not given.is_file():
            raise InputError(f"calibration {given}: no such file, expected TOML such as {EXAMPLE}")
        return given
    for place in places:
        if place.is_file():
            return place
    raise InputError(
        f"no calibration: expected {' or '.join(map(str, places))}, or the option camera.calibration; "
        f"TOML such as {EXAMPLE}"
    )


def read_calibration(path: Path) -> CameraModel:
    """The camera of a calibration file: KITTI's calib.txt (its first P line) when the name ends in .txt, else TOML.

    Raises:
        InputError: not such a file; names the file, the key or line, what was found and what was expected.
    """
    if path.suffix.lower() == ".txt":
        projection = next(iter(read_projections(path).values()))
        return CameraModel(path, projection[0, 0], projection[1, 1], projection[0, 2], projection[1, 2], None)
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(f"calibration {path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"calibration {path}: not TOML ({error}), expected {EXAMPLE}") from error
    missing = [key for key in _REQUIRED if key not in values]
    if missing:
        raise InputError(f"calibration {path}: no {', '.join(missing)}, expected {EXAMPLE}")
    unknown = sorted(values.keys() - {*_REQUIRED, *_OPTIONAL})
    if unknown:
        raise InputError(f"calibration {path}: unknown {', '.join(unknown)}, expected {EXAMPLE}")
    number = {key: _number(path, key, values[key]) for key in _REQUIRED}
    for key in ("fx", "fy", "width", "height"):
        if number[key] <= 0 or (key in ("width", "height") and number[key] != int(number[key])):
            raise InputError(f"calibration {path}: {key} = {values[key]}, expected a positive number of px")
    rate_hz = _number(path, "rate_hz", values["rate_hz"]) if "rate_hz" in values else None
    if rate_hz is not None and rate_hz <= 0:
        raise InputError(f"calibration {path}: rate_hz = {rate_hz:g}, expected a positive number of images a second")
    return CameraModel(
        path,
        number["fx"],
        number["fy"],
        number["cx"],
        number["cy"],
        (int(number["width"]), int(number["height"])),
        _distortion(path, values.get("distortion", [])),
        rate_hz,
    )


def _number(path: Path, key: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"calibration {path}: {key} = {value!r}, expected a finite number")
    return float(value)


def _distortion(path: Path, value: Any) -> tuple[float, ...]:
    if not isinstance(value, list) or len(value) not in (0, 4, 5):
        raise InputError(f"calibration {path}: distortion = {value!r}, expected [k1, k2, p1, p2] or with k3 behind")
    coefficients = tuple(_number(path, "distortion", item) for item in value)
    return (*coefficients, 0.0) if len(coefficients) == 4 else coefficients
