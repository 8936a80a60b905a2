# SPDX-License-Identifier: Apache-2.0
"""What a simulated drive can be asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from fractions import Fraction

from services.runtime.errors import InputError

_COUNTS = (
    "parked_cars",
    "oncoming_cars",
    "leading_cars",
    "crossing_cars",
    "starting_cars",
    "walking_people",
    "crossing_people",
    "standing_people",
)
_MAX_FRAMES = 20_000
_MAX_SIDE_PX = 4096


@dataclass(frozen=True, slots=True)
class StreetOptions:
    """Options of a drive; equal options give equal bytes, frame by frame.

    The street is laid out for the whole drive but never for less than `MIN_DRIVE_M`, so that a drive of fewer frames
    is the beginning of the default one, byte for byte.

    Raises:
        InputError: a value outside its range; the message names the option, the value and what was expected.
    """

    seed: int = 7
    width: int = 640
    height: int = 192
    fx_px: float | None = None
    """Focal length, square pixels; None gives a horizontal field of view of 80 degrees."""
    frames: int = 320
    rate_hz: float = 10.0
    speed_m_s: float = 8.0
    camera_height_m: float = 1.65
    empty_start_m: float = 60.0
    """Nothing moves within 30 m of the camera before it has driven this far."""
    parked_cars: int = 26
    oncoming_cars: int = 5
    leading_cars: int = 1
    crossing_cars: int = 2
    starting_cars: int = 3
    walking_people: int = 14
    crossing_people: int = 3
    standing_people: int = 6
    threads: int = 1
    """Threads that cast rays; the bytes do not depend on it."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            is_whole = field.type == "int"
            if value is None and field.name == "fx_px":
                continue
            if isinstance(value, bool) or not isinstance(value, int if is_whole else (int, float)):
                expected = "a whole number" if is_whole else "a number"
                raise InputError(f"simulator {field.name}={value!r}: expected {expected}")
            if not math.isfinite(value):
                raise InputError(f"simulator {field.name}={value!r}: expected a finite number")
        self._expect("seed", 0, 2**32 - 1)
        self._expect("width", 32, _MAX_SIDE_PX)
        self._expect("height", 32, _MAX_SIDE_PX)
        if self.fx_px is not None:
            self._expect("fx_px", 0.2 * self.width, 10.0 * self.width)
        self._expect("frames", 1, _MAX_FRAMES)
        self._expect("rate_hz", 0.1, 1000.0)
        self._expect("speed_m_s", 2.0, 15.0)
        self._expect("camera_height_m", 0.3, 4.0)
        self._expect("empty_start_m", 0.0, 0.5 * self.drive_length_m)
        self._expect("threads", 0, 256)
        for name in _COUNTS:
            self._expect(name, 0, 500)
        if self.frames / self.rate_hz * self.speed_m_s > 20_000.0:
            raise InputError(f"simulator frames={self.frames}: expected a drive of at most 20000 m")

    def _expect(self, name: str, low: float, high: float) -> None:
        value = getattr(self, name)
        if not low <= value <= high:
            raise InputError(f"simulator {name}={value!r}: expected {low:g} to {high:g}")

    @property
    def drive_length_m(self) -> float:
        """Length the street is laid out for, metres along the road."""
        return max(MIN_DRIVE_M, self.speed_m_s * self.frames / self.rate_hz)

    def timestamp_ns(self, index: int) -> int:
        """Capture time of frame `index` in nanoseconds since the start, rounded down, without accumulated error."""
        return int(index * 1_000_000_000 / Fraction(self.rate_hz))


MIN_DRIVE_M = 256.0
