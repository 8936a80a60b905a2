# SPDX-License-Identifier: Apache-2.0
"""A closed loop is one line of the service's log and counted once."""

import logging
from dataclasses import replace

import numpy as np
import pytest

from schemas import topics
from schemas.records import CameraCalibration, Image, MaskSource, Objects, TrackedFrame
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.service import Bundle
from services.slam.engine_adapter import SlamEngine
from services.slam.service import SlamService
from tests.unit.slam.textured_room import TexturedRoom


def test_a_closed_loop_is_logged_and_counted(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "slam")
    room = TexturedRoom(seed=1)
    service = SlamService(load_config(None, {}))
    finish_frame = SlamEngine.finish_frame

    def recognises(engine: SlamEngine, objects: Objects | None, masks: MaskSource) -> TrackedFrame:
        frame = finish_frame(engine, objects, masks)
        return replace(frame, loop_closed=frame.timestamp_ns == 2, maps_merged=frame.timestamp_ns == 3)

    monkeypatch.setattr(SlamEngine, "finish_frame", recognises)
    for time_ns in (1, 2, 3):
        records = {
            topics.IMAGE: Image(time_ns, room.render(time_ns)[0]),
            topics.CALIBRATION: CameraCalibration(time_ns, room.width, room.height, room.intrinsics),
            topics.OBJECTS: Objects(time_ns, np.zeros((room.height, room.width), np.uint32), ()),
        }
        service.process(Bundle(Envelope("s", time_ns, time_ns), records))
    told = [(record.getMessage(), record.__dict__["fields"]) for record in caplog.records]
    assert [one for one in told if one[0] in ("loop_closed", "maps_merged")] == [
        ("loop_closed", {"map_id": 0, "timestamp_ns": 2}),
        ("maps_merged", {"map_id": 0, "timestamp_ns": 3}),
    ]
    assert service.metrics()["loops_closed"] == service.metrics()["maps_merged"] == 1
