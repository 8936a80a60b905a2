# SPDX-License-Identifier: Apache-2.0
"""A video file, read by OpenCV."""

from pathlib import Path

import cv2
import numpy as np

from schemas.records import Image
from services.camera.sources.calibration_file import find_calibration, read_calibration
from services.camera.sources.opencv_log import silence_opencv
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError

VIDEO_SUFFIXES = (".mp4", ".avi", ".mkv", ".mov", ".m4v", ".webm")
_NS_PER_MS = 1_000_000
_NS_PER_S = 1_000_000_000
_FASTEST_HZ = 1000.0


class VideoFile:
    """A video with its calibration beside it: `drive.toml` for `drive.mp4`, or calibration.toml in its folder.

    Frames are numbered by decoding from the start: seeking by number is not exact in every codec. So reading in order
    is fast, and reading an earlier frame starts again from the beginning.

    Raises:
        InputError: no video that can be decoded, no calibration, or one of another size.
    """

    def __init__(self, path: Path, *, calibration: Path | None = None) -> None:
        if not path.is_file():
            raise InputError(f"video {path}: no such file")
        self._path = path
        silence_opencv()
        self._rewind()
        self._frame_count = int(self._capture.get(cv2.CAP_PROP_FRAME_COUNT))
        rate_hz = self._capture.get(cv2.CAP_PROP_FPS)
        if not 0 < rate_hz <= _FASTEST_HZ:
            self.close()
            raise InputError(f"video {path}: {rate_hz:g} frames a second, expected more than 0 and at most 1000")
        self._rate_hz = float(rate_hz)
        size = tuple(int(self._capture.get(side)) for side in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
        try:
            found = find_calibration(calibration, path.with_suffix(".toml"), path.parent / "calibration.toml")
            self._camera = read_calibration(found).for_images((size[0], size[1]), path)
        except InputError:
            self.close()
            raise

    @property
    def name(self) -> str:
        return f"video {self._path.name}"

    @property
    def frame_count(self) -> int:
        """What the container says, -1 where it says nothing; some say more than can be decoded."""
        return self._frame_count if self._frame_count > 0 else -1

    @property
    def rate_hz(self) -> float:
        return self._rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return ()

    def frame(self, index: int) -> SourceFrame | None:
        if index < self._next_index:
            self._rewind()
        while self._next_index <= index:
            if not self._capture.grab():
                return None
            self._advance()
        decoded, pixels = self._capture.retrieve()
        if not decoded or pixels is None:
            raise InputError(f"video {self._path}: frame {index} cannot be decoded")
        if (pixels.shape[1], pixels.shape[0]) != self._camera.size:
            raise InputError(f"video {self._path}: frame {index} is {pixels.shape[1]}x{pixels.shape[0]} px, "
                             f"expected {'x'.join(map(str, self._camera.size or ()))}")  # fmt: skip
        time_ns = self._time_ns
        image = Image(time_ns, np.asarray(pixels, dtype=np.uint8))
        return SourceFrame(f"{index:06d}", time_ns, image, self._camera.record(time_ns))

    def close(self) -> None:
        self._capture.release()

    def _rewind(self) -> None:
        self._capture = cv2.VideoCapture(str(self._path))
        if not self._capture.isOpened():
            raise InputError(f"video {self._path}: cannot be decoded, expected a video that FFmpeg knows")
        # The picture as the sensor gave it: the calibration knows no rotation.
        self._capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 0)
        self._next_index = 0
        self._time_ns = -1

    def _advance(self) -> None:
        time_ns = round(self._capture.get(cv2.CAP_PROP_POS_MSEC) * _NS_PER_MS)
        if time_ns <= self._time_ns:
            # Containers without good times repeat them or count back; then the nominal rate goes on.
            time_ns = self._time_ns + round(_NS_PER_S / self._rate_hz)
        self._time_ns = time_ns
        self._next_index += 1
