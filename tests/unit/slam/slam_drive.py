# SPDX-License-Identifier: Apache-2.0
"""The slam service driven by hand through a textured room."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from schemas import topics
from schemas.codec import encode
from schemas.records import CameraCalibration, Image, MapUpdate, Objects, TrackedFrame
from schemas.topics import Topic
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.service import Bundle
from services.slam.service import SlamService
from tests.unit.slam.textured_room import TexturedRoom

FRAME_NS = 100_000_000


class SlamDrive:
    """A service, the frames it was given, and what it said of each."""

    def __init__(self, room: TexturedRoom, *, state: Path | None = None, mode: str = "lossless", **slam: Any) -> None:
        self._room = room
        self._state = state
        self._config = load_config(None, {"slam": slam, "delivery": {"mode": mode}})
        self.service = self._make_service()
        self.tracked: list[TrackedFrame] = []
        self.updates: list[MapUpdate] = []
        self.sent: list[tuple[bytes, ...]] = []

    def take(self, images: Iterable[npt.NDArray[np.uint8]]) -> "SlamDrive":
        """The next frames."""
        for pixels in images:
            sequence = len(self.tracked)
            time_ns = (sequence + 1) * FRAME_NS
            records: dict[Topic, Any] = {
                topics.IMAGE: Image(time_ns, pixels),
                topics.CALIBRATION: CameraCalibration(
                    time_ns, self._room.width, self._room.height, self._room.intrinsics
                ),
                topics.OBJECTS: Objects(time_ns, np.zeros(pixels.shape, dtype=np.uint32), ()),
            }
            outgoing = self.service.process(Bundle(Envelope("s", sequence, time_ns), records))
            by_topic = {out.topic: out.record for out in outgoing}
            self.tracked.append(by_topic[topics.TRACKED_FRAME])
            self.updates.append(by_topic[topics.MAP_UPDATE])
            self.sent.append(tuple(_without_times(out.topic, out.record) for out in outgoing))
        return self

    def finish(self) -> "SlamDrive":
        """The end of the input."""
        sequence = len(self.tracked)
        bundle = Bundle(Envelope("s", sequence, sequence * FRAME_NS), {})
        (out,) = self.service.finish(bundle)
        self.updates.append(out.record)
        self.sent.append((encode(out.topic, out.record),))
        return self

    def fall_and_rise(self) -> "SlamDrive":
        """What kill -9 and the supervisor do: another service, with nothing but what is on disk."""
        state = self.service.snapshot()
        exact = self._config.delivery.mode == "lossless"
        self.service = self._make_service()
        if exact:
            self.service.restore(state)
        return self

    def keyframes_by_map(self) -> dict[int, set[int]]:
        """Map -> the keyframes that were ever said to be in it."""
        keyframes: dict[int, set[int]] = {}
        for update in self.updates:
            for number, map_id in zip(update.keyframe_id.tolist(), update.keyframe_map_id.tolist(), strict=True):
                keyframes.setdefault(map_id, set()).add(number)
        return keyframes

    def _make_service(self) -> SlamService:
        service = SlamService(self._config)
        if self._state is not None:
            service.keep_state_in(self._state)
        return service


def _without_times(topic: Topic, record: Any) -> bytes:
    """The message as sent, but for how long each step took."""
    if isinstance(record, TrackedFrame):
        record.stage_ms.clear()
    return encode(topic, record)
