# SPDX-License-Identifier: Apache-2.0
"""A short session through each service alone, compared with what it gave when the golden session was made.

Every service gets the golden outputs of those before it, so that a difference is its own. Tolerances allow for another
processor's rounding, not for another result.
"""

from collections import defaultdict
from typing import Any

import numpy as np
import pytest

from schemas import topics
from schemas.codec import decode, encode
from schemas.records import Density, EgoMotion, InstanceMotions, Instances, MapUpdate, MovingMask, Objects, TrackedFrame
from schemas.topics import Topic
from services.runtime.config import Config
from services.runtime.envelope import Envelope
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.outbox import Outbox
from services.runtime.service_loop import FrameLoop
from services.runtime.session_file import SessionFile
from tests.pipeline_rig import SERVICES, SHORT_FRAMES, short_drive
from tests.replay.golden_session import GOLDEN, camera_records

Messages = dict[Topic, dict[int, bytes]]


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Config:
    return short_drive(tmp_path_factory.mktemp("replay"))


@pytest.fixture(scope="module")
def golden(config: Config) -> Messages:
    """Everything on the bus of the golden session: the camera's part made again, the rest from the file."""
    messages: Messages = defaultdict(dict)
    for sequence, records in camera_records(config).items():
        for topic, record in records:
            messages[topic][sequence] = encode(topic, record)
    with SessionFile(GOLDEN) as session:
        for message in session.messages():
            messages[topics.BY_KEY[message.key]][message.sequence] = message.payload
    return messages


def replay(name: str, config: Config, golden: Messages) -> Messages:
    """What the service gives today for the golden session."""
    service = SERVICES[name](config)
    network = FakeNetwork()
    loop = FrameLoop(service, FakeBus(network), config.delivery, config.run.session, Outbox(4, None))
    given = [topic for topic in topics.TOPICS if topic.producer == name]
    heard = FakeBus(network).subscribe(given)
    sender = FakeBus(network)
    taken = [topics.MANIFEST, *service.awaits, *service.final_awaits, topics.END]
    times = {
        sequence: decode(topics.MANIFEST, payload).timestamp_ns for sequence, payload in golden[topics.MANIFEST].items()
    }
    times[SHORT_FRAMES] = times[SHORT_FRAMES - 1] + 1
    for sequence in range(SHORT_FRAMES + 1):
        for topic in dict.fromkeys(taken):
            if sequence in golden[topic]:
                sender.publish(topic, golden[topic][sequence], Envelope(config.run.session, sequence, times[sequence]))
        while loop.step(0.0):
            pass
    service.close()
    outputs: Messages = defaultdict(dict)
    while (message := heard.receive(0.0)) is not None:
        outputs[message.topic][message.envelope.sequence] = message.payload
    return outputs


def pairs(topic: Topic, now: Messages, golden: Messages) -> list[tuple[Any, Any]]:
    """Today's record beside the golden one, for every frame of the golden session."""
    assert sorted(now[topic]) == sorted(golden[topic]), topic.key
    assert golden[topic], topic.key
    return [(decode(topic, now[topic][s]), decode(topic, golden[topic][s])) for s in sorted(golden[topic])]


def test_segmenter(config: Config, golden: Messages) -> None:
    now = replay("segmenter", config, golden)
    one: Instances
    other: Instances
    for one, other in pairs(topics.INSTANCES, now, golden):
        assert [(i.instance_id, i.category) for i in one.instances] == [
            (i.instance_id, i.category) for i in other.instances
        ]
        assert np.mean(one.labels != other.labels) < 0.002


def test_motion(config: Config, golden: Messages) -> None:
    now = replay("motion", config, golden)
    ego: EgoMotion
    ego_golden: EgoMotion
    for ego, ego_golden in pairs(topics.EGO_MOTION, now, golden):
        assert ego.valid == ego_golden.valid
        np.testing.assert_allclose(ego.rotation, ego_golden.rotation, atol=2e-3)
        np.testing.assert_allclose(ego.translation_direction, ego_golden.translation_direction, atol=0.1)
    one: InstanceMotions
    other: InstanceMotions
    differences = []
    for one, other in pairs(topics.INSTANCE_MOTIONS, now, golden):
        assert [i.instance_id for i in one.instances] == [i.instance_id for i in other.instances]
        differences += [
            abs(a.moving_probability - b.moving_probability)
            for a, b in zip(one.instances, other.instances, strict=True)
        ]
    assert differences
    assert np.percentile(differences, 95) < 0.1
    mask: MovingMask
    for mask, other_mask in pairs(topics.MOVING_MASK, now, golden):
        assert np.mean(mask.mask != other_mask.mask) < 0.02


def test_tracker(config: Config, golden: Messages) -> None:
    now = replay("tracker", config, golden)
    one: Objects
    other: Objects
    for one, other in pairs(topics.OBJECTS, now, golden):
        assert [(o.object_id, o.category, o.motion_state) for o in one.objects] == [
            (o.object_id, o.category, o.motion_state) for o in other.objects
        ]
        np.testing.assert_array_equal(one.track_image, other.track_image)


def test_slam(config: Config, golden: Messages) -> None:
    now = replay("slam", config, golden)
    one: TrackedFrame
    other: TrackedFrame
    for one, other in pairs(topics.TRACKED_FRAME, now, golden):
        assert one.state == other.state
        assert one.metric_scale == other.metric_scale
        if one.map_from_camera is not None and other.map_from_camera is not None:
            np.testing.assert_allclose(one.map_from_camera, other.map_from_camera, atol=0.1)
    update: MapUpdate
    counts: dict[str, list[int]] = {"now": [], "golden": []}
    for update, update_golden in pairs(topics.MAP_UPDATE, now, golden):
        counts["now"].append(len(update.landmark_id))
        counts["golden"].append(len(update_golden.landmark_id))
    assert sum(counts["now"]) == pytest.approx(sum(counts["golden"]), rel=0.1)


def test_mapstore(config: Config, golden: Messages) -> None:
    now = replay("mapstore", config, golden)
    one: Density
    other: Density
    for one, other in pairs(topics.DENSITY, now, golden):
        assert (one.level, one.moving_points, one.moving_objects) == (
            other.level,
            other.moving_points,
            other.moving_objects,
        )
        assert one.observed_points == other.observed_points
        np.testing.assert_allclose(one.position, other.position, atol=1e-6)


def test_the_golden_session_shows_what_it_is_for(golden: Messages) -> None:
    """It tracks, and it has parked and moving things: else the comparisons above compare nothing."""
    frames = [decode(topics.TRACKED_FRAME, payload) for payload in golden[topics.TRACKED_FRAME].values()]
    assert sum(frame.map_from_camera is not None for frame in frames) >= SHORT_FRAMES - 10
    states = {
        row.motion_state.name
        for payload in golden[topics.OBJECTS].values()
        for row in decode(topics.OBJECTS, payload).objects
    }
    assert {"MOVING", "NON_MOVING"} <= states
    assert GOLDEN.stat().st_size < 2_000_000
