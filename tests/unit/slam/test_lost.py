# SPDX-License-Identifier: Apache-2.0
"""A camera that is lost gets a new map in the end, and the old one is kept."""

import numpy as np
import pytest

from schemas import topics
from schemas.records import CameraCalibration, Image, MapUpdate, MaskSource, Objects, TrackedFrame, TrackingState
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.service import Bundle
from services.slam.lost_policy import LostPolicy
from services.slam.service import SlamService
from tests.unit.slam.textured_room import TexturedRoom


def frame(state: TrackingState, *, keyframe: bool = False) -> TrackedFrame:
    return TrackedFrame(0, state, "", 0, None, None, -1, None, 0, 0, keyframe, MaskSource.FRESH, False, "moving")


@pytest.mark.parametrize(("keyframes", "patience", "expected"), [(2, 50, 5), (30, 50, 50), (2, 3, 3), (30, 1, 1)])
def test_a_young_map_is_given_up_sooner(keyframes: int, patience: int, expected: int) -> None:
    policy = LostPolicy(patience)
    assert not any(policy.gives_up(frame(TrackingState.TRACKING, keyframe=True)) for _ in range(keyframes))
    lost = [policy.gives_up(frame(TrackingState.LOST)) for _ in range(expected)]
    assert lost == [False] * (expected - 1) + [True]


def test_a_found_camera_starts_counting_anew() -> None:
    policy = LostPolicy(3)
    for state in (TrackingState.LOST, TrackingState.LOST, TrackingState.TRACKING, TrackingState.LOST):
        assert not policy.gives_up(frame(state))


def test_after_darkness_elsewhere_a_second_map_begins() -> None:
    service = SlamService(load_config(None, {"slam": {"new_map_after_lost": 4}}))
    before, after = TexturedRoom(seed=1), TexturedRoom(seed=2)
    black = np.zeros((before.height, before.width), dtype=np.uint8)
    pixels = [before.render(n)[0] for n in range(12)] + [black] * 6 + [after.render(n)[0] for n in range(12)]
    tracked: list[TrackedFrame] = []
    keyframes: dict[int, set[int]] = {}
    for sequence, image in enumerate(pixels):
        time_ns = (sequence + 1) * 100_000_000
        records = {
            topics.IMAGE: Image(time_ns, image),
            topics.CALIBRATION: CameraCalibration(time_ns, before.width, before.height, before.intrinsics),
            topics.OBJECTS: Objects(time_ns, np.zeros(black.shape, dtype=np.uint32), ()),
        }
        outgoing = {out.topic: out.record for out in service.process(Bundle(Envelope("s", sequence, time_ns), records))}
        tracked.append(outgoing[topics.TRACKED_FRAME])
        update: MapUpdate = outgoing[topics.MAP_UPDATE]
        for number, map_id in zip(update.keyframe_id.tolist(), update.keyframe_map_id.tolist(), strict=True):
            keyframes.setdefault(map_id, set()).add(number)
    assert TrackingState.LOST in [one.state for one in tracked[12:18]]
    assert (tracked[11].map_id, tracked[-1].map_id) == (0, 1)
    assert tracked[11].state is tracked[-1].state is TrackingState.TRACKING
    assert set(keyframes) == {0, 1}
    assert not keyframes[0] & keyframes[1]
