# SPDX-License-Identifier: Apache-2.0
"""A camera that sees now: the newest frame wins, and one that goes away is opened again."""

import threading
import time
from collections.abc import Callable
from typing import Any, Protocol

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, Image
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError
from services.runtime.log import get_logger

_ASSUMED_RATE_HZ = 30.0
_FASTEST_HZ = 1000.0
STREAM_TIMEOUT_MS = 5000
"""how long a silent stream is waited for"""
_BACKOFF_S = (0.5, 1.0, 2.0, 4.0, 8.0)


class Capture(Protocol):
    """What of cv2.VideoCapture is used."""

    def grab(self) -> bool:
        """Wait for the next frame; whether there is one."""

    def retrieve(self) -> tuple[bool, Any]:
        """Decode the frame that was grabbed."""

    def get(self, property_id: int) -> float:
        """A property of OpenCV's, 0 where it is not known."""

    def release(self) -> None:
        """Let go of the camera."""


OpenCapture = Callable[[], Capture | None]
"""Opens the camera; None when it cannot be reached now."""


class LiveCamera:
    """Gives each frame once, the newest there is; frames that nobody asked for in time are gone.

    Unlike other sources' `frame`, this one's is no function of the index: it waits for a frame that was not given
    yet, as long as it takes, and returns None once the camera is closed. Times are this machine's clock when the
    frame came, kept increasing. A camera that goes away is opened again and again, more and more slowly.

    Args:
        name: what this camera is, for people; without its password.
        open_capture: opens it; called again after every loss.
        calibration: of the camera by the (width, height) of its frames; its time does not count.
        backoff_s: how long to wait before each try to open it again; the last one goes on.

    Raises:
        InputError: the camera cannot be opened, or gives no frame.
    """

    def __init__(
        self,
        name: str,
        open_capture: OpenCapture,
        calibration: Callable[[tuple[int, int]], CameraCalibration],
        *,
        notes: tuple[str, ...] = (),
        backoff_s: tuple[float, ...] = _BACKOFF_S,
    ) -> None:
        self._name = name
        self._notes = notes
        self._open_capture = open_capture
        self._backoff_s = backoff_s
        self._log = get_logger("camera")
        self._changed = threading.Condition()
        self._closed = threading.Event()
        self._newest: Image | None = None
        self._last_ns = -1
        self._epoch_ns = time.time_ns() - time.monotonic_ns()
        capture = open_capture()
        pixels = self._stamped(capture) if capture is not None and capture.grab() else None
        if capture is None or pixels is None:
            if capture is not None:
                capture.release()
            raise InputError(f"{name}: gives no frame, expected a camera that can be reached and is not in use")
        try:
            self._calibration = calibration((pixels.shape[1], pixels.shape[0]))
        except InputError:
            capture.release()
            raise
        rate_hz = float(capture.get(cv2.CAP_PROP_FPS))
        self._rate_hz = rate_hz if 0 < rate_hz <= _FASTEST_HZ else _ASSUMED_RATE_HZ
        self._thread = threading.Thread(target=self._watch, args=(capture,), name="live-camera", daemon=True)
        self._thread.start()

    @property
    def name(self) -> str:
        return self._name

    @property
    def frame_count(self) -> int:
        """-1: nobody knows."""
        return -1

    @property
    def rate_hz(self) -> float:
        """As the camera says, 30 where it does not."""
        return self._rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return self._notes

    def frame(self, index: int) -> SourceFrame | None:
        """The newest frame that was not given yet, under the name `index`; None once the camera is closed.

        Raises:
            InputError: the frames are of another size than at the start.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not None or self._closed.is_set())
            image, self._newest = self._newest, None
        if image is None or self._closed.is_set():
            return None
        height, width = image.pixels.shape[:2]
        expected = self._calibration
        if (width, height) != (expected.width, expected.height):
            raise InputError(f"{self._name}: {width}x{height} px now, expected {expected.width}x{expected.height}")
        calibration = CameraCalibration(
            image.timestamp_ns, width, height, expected.intrinsics, expected.distortion, expected.projection
        )
        return SourceFrame(f"{index:06d}", image.timestamp_ns, image, calibration)

    def close(self) -> None:
        """Let go of the camera, and of whoever waits for its next frame; again does no harm."""
        with self._changed:
            self._closed.set()
            self._changed.notify_all()
        # A stream that is silent keeps its reader until the time-out.
        self._thread.join(timeout=STREAM_TIMEOUT_MS / 1e3 + 1.0)

    def _watch(self, capture: Capture | None) -> None:
        tries = 0
        lost_s = time.monotonic()
        while not self._closed.is_set():
            if capture is not None and capture.grab():
                if tries:
                    self._log.warning("camera_is_back", camera=self._name, after_s=f"{time.monotonic() - lost_s:.1f}")
                tries = 0
                lost_s = time.monotonic()
                self._offer(self._stamped(capture))
                continue
            if capture is not None:
                capture.release()
                capture = None
            if self._closed.is_set():
                break
            wait_s = self._backoff_s[min(tries, len(self._backoff_s) - 1)]
            tries += 1
            self._log.warning("camera_is_lost", camera=self._name, tries=tries, next_try_in_s=f"{wait_s:g}")
            if not self._closed.wait(wait_s):
                capture = self._open_capture()
        if capture is not None:
            capture.release()

    def _stamped(self, capture: Capture) -> npt.NDArray[np.uint8] | None:
        """The frame that was grabbed just now; None for one that came broken."""
        grabbed_ns = self._epoch_ns + time.monotonic_ns()
        self._last_ns = max(grabbed_ns, self._last_ns + 1)
        decoded, pixels = capture.retrieve()
        return np.asarray(pixels, dtype=np.uint8) if decoded and pixels is not None else None

    def _offer(self, pixels: npt.NDArray[np.uint8] | None) -> None:
        if pixels is None:
            self._log.warning_limited("frame_is_broken", camera=self._name)
            return
        with self._changed:
            self._newest = Image(self._last_ns, pixels)
            self._changed.notify_all()
