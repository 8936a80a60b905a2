# SPDX-License-Identifier: Apache-2.0
"""What a recording of messages is to the camera, whichever robot software wrote it."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError, KinemapError

Kind = Literal["image", "info", "pose"]


class LoggedTopic(NamedTuple):
    """A topic that the camera can use."""

    name: str
    kind: Kind
    type_name: str
    messages: int


class LoggedMessage(NamedTuple):
    """Where one message lies."""

    stamp_ns: int
    """the time in its header; the time at which it was recorded where the header has none"""
    recorded_ns: int
    number: int
    """among the messages of its topic recorded at the same time"""


@dataclass(frozen=True)
class RawPixels:
    """An image as rows of `step` bytes; `encoding` is ROS's or Foxglove's name, which mostly agree."""

    frame_id: str
    width: int
    height: int
    encoding: str
    step: int
    data: npt.NDArray[np.uint8]
    big_endian: bool = False


@dataclass(frozen=True)
class CompressedPixels:
    """An image as a JPEG, PNG or such file; `format` is what the writer called it."""

    frame_id: str
    format: str
    data: npt.NDArray[np.uint8]


@dataclass(frozen=True)
class CameraInfo:
    """A camera as sensor_msgs/CameraInfo and foxglove.CameraCalibration tell it."""

    width: int
    height: int
    distortion_model: str
    distortion: tuple[float, ...]
    intrinsics: npt.NDArray[np.float64]
    """(3, 3) of the image as it was taken, px"""
    projection: npt.NDArray[np.float64]
    """(3, 4) of the rectified image, px"""


@dataclass(frozen=True)
class LoggedPose:
    """(7,) tx ty tz qx qy qz qw of `child_frame_id`, whose name is empty where the message does not tell."""

    child_frame_id: str
    pose: npt.NDArray[np.float64]


@dataclass(frozen=True)
class StaticTransform:
    """(4, 4) parent_from_child in metres of two frames fixed to each other."""

    parent: str
    child: str
    parent_from_child: npt.NDArray[np.float64]


class MessageLog(Protocol):
    """A recording, open. Not for several threads at once. All methods raise InputError where it is damaged."""

    @property
    def name(self) -> str:
        """What this recording is, for people."""

    @property
    def topics(self) -> list[LoggedTopic]:
        """The topics that hold messages of a known kind, by name."""

    def index(self, topic: str) -> list[LoggedMessage]:
        """Where a topic's messages lie, in the order of their recording; reads over the file once."""

    def image(self, topic: str, place: LoggedMessage) -> RawPixels | CompressedPixels:
        """An image message."""

    def info(self, topic: str, place: LoggedMessage) -> CameraInfo:
        """A calibration message."""

    def pose(self, topic: str, place: LoggedMessage) -> LoggedPose:
        """A pose message."""

    def static_transforms(self) -> list[StaticTransform]:
        """How the robot's frames sit on each other, as far as the recording tells."""

    def close(self) -> None:
        """Close the recording."""


@contextmanager
def damage_refused(what: str, expected: str) -> Iterator[None]:
    """Whatever a reader stumbles over in `what`, as one InputError that says what was `expected`."""
    try:
        yield
    except KinemapError:
        raise
    # mcap, rosbags, protobuf, and SQLite, lz4 and zstd below them, meet damage with whatever they stumble over.
    except Exception as error:
        why = " ".join(str(error).split()).rstrip(".") or type(error).__name__
        raise InputError(f"{what}: cut off or damaged ({why}), expected {expected}") from error
