# SPDX-License-Identifier: Apache-2.0
"""A session goes back onto the bus as it was, and its camera runs the pipeline again."""

import threading
from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import FrameAnswer
from services.camera.configured_source import open_configured_source
from services.camera.frame_records import frame_records
from services.camera.sources.recordings.mcap_session import McapSession
from services.recorder.replay_pace import AsAnswered, RecordedRate
from services.recorder.replayer import Replayer
from services.recorder.session_writer import SessionWriter, WriterOptions
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.errors import InputError, KinemapError
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.session_file import RecordedMessage, SessionFile
from tests.unit.recorder.recorded_frames import SESSION, payload, recorded_frame, time_of

FRAMES = 5
GO = threading.Event()


@pytest.fixture
def session(tmp_path: Path) -> Path:
    path = tmp_path / "session.mcap"
    writer = SessionWriter(path, SESSION, "{}", WriterOptions(reserve_bytes=0))
    for sequence in range(FRAMES):
        writer.append(recorded_frame(sequence))
    writer.finish()
    writer.close()
    return path


def test_every_message_as_it_was(session: Path) -> None:
    network = FakeNetwork()
    heard = FakeBus(network).subscribe(topics.TOPICS)
    with SessionFile(session) as file:
        count = Replayer(file, FakeBus(network)).play(AsAnswered(FakeBus(network), SESSION, (), stop=GO))
    expected = [message for sequence in range(FRAMES) for message in recorded_frame(sequence)]
    got = [heard.receive(0.0) for _ in range(count)]
    assert heard.receive(0.0) is None
    assert [
        RecordedMessage(message.topic.key, message.envelope.sequence, message.envelope.timestamp_ns, message.payload)
        for message in got
        if message is not None
    ] == expected


def test_some_topics_under_another_session(session: Path) -> None:
    network = FakeNetwork()
    heard = FakeBus(network).subscribe(topics.TOPICS)
    with SessionFile(session) as file:
        Replayer(file, FakeBus(network), "again").play(
            AsAnswered(FakeBus(network), "again", (), stop=GO), [topics.DENSITY.key]
        )
    for sequence in range(FRAMES):
        message = heard.receive(0.0)
        assert message is not None
        assert message.envelope == Envelope("again", sequence, time_of(sequence))
        assert message.payload == payload(topics.DENSITY, sequence)
    assert heard.receive(0.0) is None


class Clock:
    """A clock that a replay's waits move on, and the event that it waits on."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s

    def is_set(self) -> bool:
        return False

    def wait(self, seconds: float) -> bool:
        self.now_s += seconds
        return False


def test_the_recorded_rate_times_a_factor(session: Path) -> None:
    clock = Clock()
    pace = RecordedRate(2.0, clock, clock)  # type: ignore[arg-type]
    times: list[float] = []
    with SessionFile(session) as file:
        Replayer(file, FakeBus(FakeNetwork())).play(pace, ["camera/image"], lambda _: times.append(clock.now_s))
    assert times == pytest.approx([100.0, 100.05, 100.1, 100.15, 100.2])


def test_a_clock_that_jumps_back_does_not_stop_the_replay() -> None:
    clock = Clock()
    pace = RecordedRate(1.0, clock, clock)  # type: ignore[arg-type]
    for time_ns in (5_000_000_000, 6_000_000_000, 1_000_000_000, 2_000_000_000):
        assert pace.await_turn(RecordedMessage("camera/image", 0, time_ns, b""))
    assert clock.now_s == pytest.approx(102.0)


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan")])
def test_a_speed_that_is_none(speed: float) -> None:
    with pytest.raises(ValueError, match="expected a positive number"):
        RecordedRate(speed, GO)


def test_no_frame_runs_ahead_of_the_answers(session: Path) -> None:
    network = FakeNetwork()
    bus, other = FakeBus(network), FakeBus(network)
    pace = AsAnswered(bus, SESSION, ("slam", "mapstore"), stop=GO, window=2, patience_s=0.3)
    newest = {"slam": -1, "mapstore": -1}

    def answer(message: RecordedMessage) -> None:
        assert message.sequence - min(newest.values()) <= 2
        for service in newest:
            record = FrameAnswer(message.timestamp_ns, service)
            envelope = Envelope(SESSION, message.sequence, message.timestamp_ns)
            other.publish(topics.ANSWER, encode(topics.ANSWER, record), envelope, service)
            newest[service] = message.sequence

    with SessionFile(session) as file:
        assert Replayer(file, bus).play(pace, ["camera/image"], answer) == FRAMES
        silent = AsAnswered(bus, SESSION, ("slam",), stop=GO, window=2, patience_s=0.0)
        with pytest.raises(KinemapError, match="frame 0: no answer from slam"):
            Replayer(file, bus).play(silent, ["camera/image"])


def test_a_replay_stops_when_told(session: Path) -> None:
    stop = threading.Event()
    with SessionFile(session) as file:
        count = Replayer(file, FakeBus(FakeNetwork())).play(
            RecordedRate(1000.0, stop), ["camera/image"], lambda message: stop.set() if message.sequence == 2 else None
        )
    assert count == 3


def test_the_camera_of_a_session_is_a_source(session: Path) -> None:
    source = McapSession(session)
    assert (source.frame_count, source.rate_hz, source.notes) == (FRAMES, 10.0, ())
    for index in (3, 0, 4):
        frame = source.frame(index)
        assert frame is not None
        assert (frame.name, frame.timestamp_ns) == (f"{index:06d}", time_of(index))
        assert encode(topics.IMAGE, frame.image) == payload(topics.IMAGE, index)
        assert encode(topics.CALIBRATION, frame.calibration) == payload(topics.CALIBRATION, index)
        assert frame.depth is frame.image_right is frame.true_pose is None
    assert source.frame(FRAMES) is None
    source.close()


def test_a_frame_that_came_in_pieces_is_put_together(tmp_path: Path) -> None:
    path = tmp_path / "session.mcap"
    writer = SessionWriter(path, SESSION, "{}", WriterOptions(reserve_bytes=0))
    manifest, calibration, image, *_ = recorded_frame(0)
    for chunk in ([manifest, calibration], recorded_frame(1), [image]):
        writer.append(chunk)
    writer.finish()
    writer.close()
    source = McapSession(path)
    frame = source.frame(0)
    assert frame is not None
    assert np.array_equal(frame.image.pixels, np.random.default_rng(0).integers(0, 256, (6, 8), dtype=np.uint8))
    source.close()


def test_sessions_without_what_a_camera_needs(tmp_path: Path, session: Path) -> None:
    path = tmp_path / "poses.mcap"
    writer = SessionWriter(path, SESSION, "{}", WriterOptions(reserve_bytes=0))
    writer.append([message for message in recorded_frame(0) if message.key == "slam/pose"])
    writer.finish()
    writer.close()
    with pytest.raises(InputError, match=r"holds no camera frames; it records \['slam/pose'\]"):
        McapSession(path)
    session.write_bytes(session.read_bytes()[:-100])
    with pytest.raises(InputError, match="cut off"):
        McapSession(session)
    source = McapSession(session, recover=True)
    assert source.frame_count == FRAMES
    assert "cut off" in source.notes[0]
    source.close()


def test_a_real_sequence_comes_back_frame_by_frame(tmp_path: Path, shared_data: Path) -> None:
    config = load_config(overrides={"camera": {"input": str(shared_data / "kitti/sequences/03"), "max_frames": 4}})
    given = open_configured_source(config)
    writer = SessionWriter(tmp_path / "session.mcap", SESSION, "{}", WriterOptions(reserve_bytes=0))
    for index in range(4):
        frame = given.frame(index)
        assert frame is not None
        records = frame_records(frame, given)
        writer.append(
            [RecordedMessage(topic.key, index, frame.timestamp_ns, encode(topic, record)) for topic, record in records]
        )
    writer.finish()
    writer.close()
    again = McapSession(tmp_path / "session.mcap")
    assert again.frame_count == 4
    for index in range(4):
        before, after = given.frame(index), again.frame(index)
        assert before is not None
        assert after is not None
        sent, sent_again = frame_records(before, given), frame_records(after, again)
        assert [topic for topic, _ in sent] == [topic for topic, _ in sent_again]
        # The manifest names its source, and a rotation of 7 digits is normalised; all else is the same bytes.
        for (topic, record), (_, record_again) in zip(sent, sent_again, strict=True):
            if topic not in (topics.MANIFEST, topics.TRUE_POSE):
                assert encode(topic, record) == encode(topic, record_again)
        assert before.true_pose is not None
        assert after.true_pose is not None
        assert np.allclose(before.true_pose.world_from_camera, after.true_pose.world_from_camera, rtol=0, atol=1e-6)
    given.close()
    again.close()
