# SPDX-License-Identifier: Apache-2.0
"""What a simulated drive can be asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Literal, get_args, get_origin, get_type_hints

from services.runtime.errors import InputError

WorldName = Literal["street", "town", "corridor"]
Lens = Literal["pinhole", "radial", "fisheye"]
Light = Literal["noon", "low_sun", "overcast", "dusk"]

MIN_DRIVE_M = 256.0
MAX_DRIVE_M = 20_000.0

_OWN_SPEED_M_S: dict[WorldName, float] = {"street": 8.0, "town": 8.0, "corridor": 1.2}
_MAX_FRAMES = 20_000
_MAX_SIDE_PX = 4096
_ACTORS = (0, 500)
_SHARE = (0.0, 1.0)
_RANGES: dict[str, tuple[float, float]] = {
    "seed": (0, 2**32 - 1),
    "traffic_seed": (0, 2**32 - 1),
    "width": (32, _MAX_SIDE_PX),
    "height": (32, _MAX_SIDE_PX),
    "frames": (1, _MAX_FRAMES),
    "rate_hz": (0.1, 1000.0),
    "speed_m_s": (0.3, 15.0),
    "camera_height_m": (0.3, 4.0),
    "lateral_offset_m": (-1.5, 1.5),
    "start_m": (0.0, MAX_DRIVE_M),
    "threads": (0, 256),
    "loop_m": (500.0, 3000.0),
    "max_slope": (0.0, 0.12),
    "traffic": _SHARE,
    "parked": _SHARE,
    "parked_lanes": _SHARE,
    "parked_cars": _ACTORS,
    "oncoming_cars": _ACTORS,
    "leading_cars": _ACTORS,
    "crossing_cars": _ACTORS,
    "starting_cars": _ACTORS,
    "walking_people": _ACTORS,
    "crossing_people": _ACTORS,
    "standing_people": _ACTORS,
    "stereo_baseline_m": (0.0, 2.0),
    "exposure_wobble": (0.0, 1.0),
    "noise": (0.0, 50.0),
    "motion_blur": _SHARE,
    "pixel_rain": (0.0, 0.5),
    "frozen_frames": (0.0, 0.5),
    "missing_frames": (0.0, 0.5),
    "blackout_start": (0, _MAX_FRAMES),
    "blackout_frames": (0, _MAX_FRAMES),
}
_COEFFICIENTS = {"pinhole": 0, "radial": 5, "fisheye": 4}
_LARGEST_COEFFICIENT = 1e3
_OF_WORLDS: dict[str, tuple[WorldName, ...]] = {
    **dict.fromkeys(("loop_m", "max_slope", "parked", "parked_lanes"), ("town",)),
    **dict.fromkeys(("start_m", "traffic"), ("town", "corridor")),
    **dict.fromkeys(("empty_start_m", "parked_cars", "oncoming_cars", "leading_cars", "crossing_cars"), ("street",)),
    **dict.fromkeys(("starting_cars", "walking_people", "crossing_people", "standing_people"), ("street",)),
}
"""Options that mean nothing elsewhere."""


@dataclass(frozen=True, slots=True)
class DriveOptions:
    """Options of a drive; equal options give equal bytes, frame by frame.

    A drive of fewer frames is the beginning of the longer one, byte for byte (the street: up to `MIN_DRIVE_M`).

    Raises:
        InputError: a value outside its range; the message names the option, the value and what was expected.
    """

    world: WorldName = "street"
    seed: int = 7
    """What stands, how it looks, and, where `traffic_seed` is not given, who moves."""
    traffic_seed: int | None = None
    """Who is there and how they move: the same place with other traffic."""
    frames: int = 320
    rate_hz: float = 10.0
    speed_m_s: float = 0.0
    """The camera's speed; 0 asks for the world's own (8 m/s in streets, 1.2 m/s in the corridor) and reads as that."""
    lateral_offset_m: float = 0.0
    """The camera's way beside its usual one, left positive: a second drive that is not the first one again."""
    threads: int = 1
    """Threads that cast rays (0: all cores); the bytes do not depend on it."""

    # Camera and lens.
    width: int = 640
    height: int = 192
    fx_px: float | None = None
    """Focal length, square pixels; None gives a horizontal field of view of 80 degrees (before distortion)."""
    camera_height_m: float = 1.65
    lens: Lens = "pinhole"
    """radial: Brown-Conrady; fisheye: Kannala-Brandt; both with `distortion`."""
    distortion: tuple[float, ...] = ()
    """radial: k1 k2 p1 p2 k3; fisheye: k1 k2 k3 k4; as OpenCV gives them."""
    stereo_baseline_m: float = 0.0
    """A second camera this far to the right of the first, its axes parallel; 0: none."""

    # What light and sensor do to the image; the truth stays what it is.
    light: Light = "noon"
    shadows: bool = False
    """Cast shadows of everything; costs a second ray a pixel."""
    exposure_wobble: float = 0.0
    """How far, in stops, the exposure swings."""
    noise: float = 0.0
    """Standard deviation of the sensor's noise in grey levels at medium grey."""
    motion_blur: float = 0.0
    """Share of the time between two frames that the shutter is open."""
    pixel_rain: float = 0.0
    """Share of pixels hit by black or white, others in each frame."""
    frozen_frames: float = 0.0
    """Share of frames that show the one before once more."""
    missing_frames: float = 0.0
    """Share of frames that never come; the time goes on."""
    blackout_start: int = 0
    """First of `blackout_frames` black frames."""
    blackout_frames: int = 0

    # The town: a closed loop through several blocks.
    loop_m: float = 640.0
    """Length of the loop, as near as the blocks allow, never shorter than 500 m."""
    start_m: float = 0.0
    """Where on the loop the drive begins."""
    max_slope: float = 0.05
    """The steepest a street gets, rise over run."""
    traffic: float = 0.3
    """How much moves: 0 nothing, 1 about a third of the image."""
    parked: float = 0.5
    """Share of the parking bays that are taken."""
    parked_lanes: float = 0.0
    """Share of the lanes beside the camera's own on which vehicles are parked bumper to bumper; needs traffic 0."""

    # The street: how many of each kind.
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

    def __post_init__(self) -> None:
        types = get_type_hints(type(self))
        for field in fields(self):
            self._expect_type(field.name, types[field.name])
        if self.speed_m_s == 0.0:
            object.__setattr__(self, "speed_m_s", _OWN_SPEED_M_S[self.world])
        for name, (low, high) in _RANGES.items():
            self._expect(name, low, high)
        for field in fields(self):
            self._expect_meant(field.name, field.default)
        self._expect("fx_px", 0.2 * self.width, 10.0 * self.width)
        self._expect("empty_start_m", 0.0, 0.5 * self.drive_length_m)
        if self.world == "street":
            self._expect("speed_m_s", 2.0, 15.0)
        wanted = _COEFFICIENTS[self.lens]
        if len(self.distortion) != wanted:
            expected = f"{wanted} numbers for the lens {self.lens!r}"
            raise InputError(f"simulator distortion={self.distortion!r}: expected {expected}")
        if any(abs(value) > _LARGEST_COEFFICIENT for value in self.distortion):
            expected = f"coefficients within {_LARGEST_COEFFICIENT:g} of zero"
            raise InputError(f"simulator distortion={self.distortion!r}: expected {expected}")
        if self.blackout_frames and self.blackout_start >= self.frames:
            expected = f"a blackout that begins before frame {self.frames}, the end"
            raise InputError(f"simulator blackout_start={self.blackout_start}: expected {expected}")
        if self.parked_lanes and self.traffic:
            expected = "0 while there is traffic to use the lanes"
            raise InputError(f"simulator parked_lanes={self.parked_lanes!r}: expected {expected} ({self.traffic:g})")
        if self.frames / self.rate_hz * self.speed_m_s > MAX_DRIVE_M:
            raise InputError(f"simulator frames={self.frames}: expected a drive of at most {MAX_DRIVE_M:g} m")

    def _expect_type(self, name: str, hint: object) -> None:
        value = getattr(self, name)
        if get_origin(hint) is Literal:
            if value not in get_args(hint):
                raise InputError(f"simulator {name}={value!r}: expected one of {', '.join(get_args(hint))}")
            return
        if hint is bool:
            if not isinstance(value, bool):
                raise InputError(f"simulator {name}={value!r}: expected true or false")
            return
        if value is None and type(None) in get_args(hint):
            return
        numbers = value if get_origin(hint) is tuple else (value,)
        whole = hint is int or int in get_args(hint)
        for number in numbers:
            if isinstance(number, bool) or not isinstance(number, int if whole else (int, float)):
                raise InputError(f"simulator {name}={value!r}: expected {'a whole number' if whole else 'a number'}")
            if not math.isfinite(number):
                raise InputError(f"simulator {name}={value!r}: expected a finite number")

    def _expect(self, name: str, low: float, high: float) -> None:
        value = getattr(self, name)
        if value is not None and not low <= value <= high:
            raise InputError(f"simulator {name}={value!r}: expected {low:.10g} to {high:.10g}")

    def _expect_meant(self, name: str, default: object) -> None:
        """An option of another world is refused rather than passed over in silence."""
        value, worlds = getattr(self, name), _OF_WORLDS.get(name, (self.world,))
        if value != default and self.world not in worlds:
            expected = f"this option in the world {' or '.join(worlds)} only, not in the {self.world}"
            raise InputError(f"simulator {name}={value!r}: expected {expected}")

    @property
    def seed_of_traffic(self) -> int:
        """The seed of who moves."""
        return self.seed if self.traffic_seed is None else self.traffic_seed

    @property
    def drive_length_m(self) -> float:
        """Way that the camera drives, metres; never less than `MIN_DRIVE_M`, which the street is laid out for."""
        return max(MIN_DRIVE_M, self.speed_m_s * self.frames / self.rate_hz)

    def timestamp_ns(self, index: int) -> int:
        """Capture time of frame `index` in nanoseconds since the start, rounded down, without accumulated error."""
        return int(index * 1_000_000_000 / Fraction(self.rate_hz))
