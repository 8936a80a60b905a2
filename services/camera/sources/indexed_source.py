# SPDX-License-Identifier: Apache-2.0
"""What recorded inputs have in common: images by index, each with its time, its camera and its truth."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, DepthImage, Image, TruePose
from services.camera.sources.source import SourceFrame

Pose = npt.NDArray[np.float64]


class Images(Protocol):
    """Images of one size by index."""

    size: tuple[int, int]
    """(width, height) in px of each"""

    def __len__(self) -> int: ...

    def name(self, index: int) -> str:
        """What the image is called, without suffix."""

    def read(self, index: int) -> npt.NDArray[np.uint8]:
        """The pixels, (H, W) grey or (H, W, 3) blue-green-red. Raises InputError for a broken image."""


class Depths(Protocol):
    """Depth images by index, in the pixels of the left camera."""

    def read(self, index: int) -> npt.NDArray[np.float32]:
        """(H, W) along the optical axis in metres, 0 where there is none. Raises InputError for a broken image."""


@dataclass(frozen=True)
class CameraImages:
    """One camera: its images, and its calibration, whose own time does not count."""

    images: Images
    calibration: CameraCalibration


class IndexedSource:
    """A sequence that is indexed already; everything is by frame.

    Args:
        name: what this input is, for people.
        times_ns: when each frame was captured, increasing.
        rate_hz: nominal frames a second.
        left: the camera in use.
        right: the other camera of a rectified pair, its projection saying the baseline.
        depths: registered to the left camera.
        world_from_camera: (4, 4) of the left camera in metres, None for a frame without truth.
        notes: what had to be assumed.
    """

    def __init__(
        self,
        name: str,
        times_ns: Sequence[int],
        rate_hz: float,
        left: CameraImages,
        *,
        right: CameraImages | None = None,
        depths: Depths | None = None,
        world_from_camera: Sequence[Pose | None] | Pose | None = None,
        notes: Sequence[str] = (),
    ) -> None:
        self._name = name
        self._times_ns = times_ns
        self._rate_hz = rate_hz
        self._left = left
        self._right = right
        self._depths = depths
        self._world_from_camera = world_from_camera
        self._notes = tuple(notes)

    @property
    def name(self) -> str:
        return self._name

    @property
    def frame_count(self) -> int:
        return len(self._times_ns)

    @property
    def rate_hz(self) -> float:
        return self._rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return self._notes

    def frame(self, index: int) -> SourceFrame | None:
        if index >= len(self._times_ns):
            return None
        time_ns = self._times_ns[index]
        left, right, depths = self._left, self._right, self._depths
        pose = None if self._world_from_camera is None else self._world_from_camera[index]
        return SourceFrame(
            left.images.name(index),
            time_ns,
            Image(time_ns, left.images.read(index), left.calibration.frame_id),
            replace(left.calibration, timestamp_ns=time_ns),
            image_right=None if right is None else Image(time_ns, right.images.read(index), right.calibration.frame_id),
            calibration_right=None if right is None else replace(right.calibration, timestamp_ns=time_ns),
            depth=None if depths is None else DepthImage(time_ns, depths.read(index), left.calibration.frame_id),
            true_pose=None if pose is None else TruePose(time_ns, pose),
        )

    def close(self) -> None:
        """Nothing is held open."""
