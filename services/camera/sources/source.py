# SPDX-License-Identifier: Apache-2.0
"""What every source of images is to the camera service."""

from dataclasses import dataclass
from typing import Protocol

from schemas.records import CameraCalibration, DepthImage, Image, TrueInstances, TruePose


@dataclass(frozen=True)
class SourceFrame:
    """Everything that a source has of one frame. All records carry `timestamp_ns`."""

    name: str
    """the image's name in its source, without suffix; what masks and other per-image files are found by"""
    timestamp_ns: int
    image: Image
    calibration: CameraCalibration
    image_right: Image | None = None
    calibration_right: CameraCalibration | None = None
    depth: DepthImage | None = None
    true_pose: TruePose | None = None
    true_instances: TrueInstances | None = None


class Source(Protocol):
    """An input that is already checked: to make one raises InputError for whatever can be found wrong cheaply.

    `frame` is a pure function of the index, so that a camera that was killed goes on with the same bytes; only a live
    camera's is not (see `LiveCamera`). It is called from one thread at a time, which need not be the one that made the
    source.
    """

    @property
    def name(self) -> str:
        """What this input is, for people."""

    @property
    def frame_count(self) -> int:
        """Frames in the whole input as far as its head tells; -1 where it does not. `frame` has the last word."""

    @property
    def rate_hz(self) -> float:
        """Nominal frames a second."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What had to be assumed, one line each, for the log."""

    def frame(self, index: int) -> SourceFrame | None:
        """Frame `index` (0 is the first), or None past the end. Timestamps increase with the index.

        Raises:
            InputError: the frame is there and cannot be used; names the file, what was found and what was expected.
        """

    def close(self) -> None:
        """Let go of files and threads; the source is of no use afterwards."""
