# SPDX-License-Identifier: Apache-2.0
"""A live camera whose frames a test hands out."""

import threading
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

SIZE = (64, 48)
BROKEN = 255


class ScriptedCapture:
    """A camera whose frames a test hands out one by one; None takes the camera away."""

    def __init__(self) -> None:
        self._frames: list[npt.NDArray[np.uint8] | None] = []
        self._changed = threading.Condition()
        self._grabbed: npt.NDArray[np.uint8] | None = None
        self.released = False

    def show(self, value: int | None, size: tuple[int, int] = SIZE) -> None:
        """A frame all of `value`; one that cannot be decoded for BROKEN."""
        with self._changed:
            self._frames.append(None if value is None else np.full((*size[::-1], 3), value, np.uint8))
            self._changed.notify_all()

    def wait_until_seen(self) -> None:
        """Until the camera's thread asked for more than was shown."""
        with self._changed:
            assert self._changed.wait_for(lambda: not self._frames and self._waiting, timeout=10)

    def grab(self) -> bool:
        with self._changed:
            self._waiting = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: bool(self._frames) or self.released)
            self._waiting = False
            self._grabbed = self._frames.pop(0) if self._frames else None
            return self._grabbed is not None

    def retrieve(self) -> tuple[bool, Any]:
        assert self._grabbed is not None
        broken = (self._grabbed == BROKEN).all()
        return (False, None) if broken else (True, self._grabbed)

    def get(self, property_id: int) -> float:
        return 25.0 if property_id == cv2.CAP_PROP_FPS else 0.0

    def release(self) -> None:
        with self._changed:
            self.released = True
            self._changed.notify_all()

    _waiting = False


class Cameras:
    """Opens the scripted cameras in turn; None among them cannot be reached."""

    def __init__(self, *captures: ScriptedCapture | None) -> None:
        self._left = list(captures)
        self.opened = 0

    def __call__(self) -> ScriptedCapture | None:
        self.opened += 1
        return self._left.pop(0) if self._left else None
