# SPDX-License-Identifier: Apache-2.0
"""The images and the depth images of a recording's topics by index."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from services.camera.sources.recordings.message_log import LoggedMessage, MessageLog
from services.camera.sources.recordings.message_pixels import depth_pixels, image_pixels
from services.runtime.errors import InputError


class LoggedImages:
    """The images of a topic by index; the first one tells the size of all."""

    def __init__(self, log: MessageLog, topic: str, places: Sequence[LoggedMessage]) -> None:
        self._log, self._topic, self._places = log, topic, places
        pixels = image_pixels(log.image(topic, places[0]), f"{log.name} {topic} message 0")
        self.size = (pixels.shape[1], pixels.shape[0])

    def __len__(self) -> int:
        return len(self._places)

    def name(self, index: int) -> str:
        """The image's number; recordings give no names."""
        return f"{index:06d}"

    def read(self, index: int) -> npt.NDArray[np.uint8]:
        """The pixels. Raises InputError for a broken message or one of another size."""
        where = f"{self._log.name} {self._topic} message {index}"
        pixels = image_pixels(self._log.image(self._topic, self._places[index]), where)
        _expect_size(where, pixels.shape, self.size)
        return pixels


class LoggedDepths:
    """The depth images of a topic by index, of the images' size."""

    def __init__(self, log: MessageLog, topic: str, places: Sequence[LoggedMessage], size: tuple[int, int]) -> None:
        self._log, self._topic, self._places, self._size = log, topic, places, size
        self.read(0)

    def read(self, index: int) -> npt.NDArray[np.float32]:
        """Metres. Raises InputError for a broken message or one of another size."""
        where = f"{self._log.name} {self._topic} message {index}"
        depth_m = depth_pixels(self._log.image(self._topic, self._places[index]), where)
        _expect_size(where, depth_m.shape, self._size)
        return depth_m


def _expect_size(where: str, shape: tuple[int, ...], size: tuple[int, int]) -> None:
    if (shape[1], shape[0]) != size:
        raise InputError(f"{where}: {shape[1]}x{shape[0]} px, expected {size[0]}x{size[1]} as the first image")
