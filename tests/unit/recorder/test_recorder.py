# SPDX-License-Identifier: Apache-2.0
"""The recorder on a bus: what it answers is on disk."""

from pathlib import Path

import pytest

from schemas import topics
from services.recorder.recorder import Recorder
from services.recorder.service import open_recorder
from services.runtime.bus import Message
from services.runtime.config import Config, load_config
from services.runtime.envelope import Envelope
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.session_file import SessionFile
from tests.unit.recorder.recorded_frames import SESSION, end_messages, frame_messages, payload, recorded_frame


@pytest.fixture
def config(tmp_path: Path) -> Config:
    return load_config(overrides={"run": {"out": str(tmp_path), "session": SESSION}, "recorder": {"reserve_mb": 1}})


class Rig:
    """A recorder, and the rest of the bus."""

    def __init__(self, config: Config) -> None:
        network = FakeNetwork()
        self.others = FakeBus(network)
        self.answers = self.others.subscribe([topics.ANSWER])
        self.recorder: Recorder = open_recorder(config, FakeBus(network))

    def send(self, messages: list[Message]) -> list[int]:
        """Send, let the recorder work, and give back which frames it answered."""
        for message in messages:
            self.others.publish(message.topic, message.payload, message.envelope, message.suffix)
        while self.recorder.step(0.0):
            pass
        answered = []
        while (answer := self.answers.receive(0.0)) is not None:
            if answer.suffix == "recorder":
                answered.append(answer.envelope.sequence)
        return answered


def on_disk(config: Config) -> list[int]:
    with SessionFile(config.run.out / "session.mcap", recover=True) as file:
        return [message.sequence for message in file.messages(["camera/manifest"])]


def test_an_answered_frame_is_on_disk_without_the_file_being_closed(config: Config) -> None:
    rig = Rig(config)
    assert rig.send(frame_messages(0)[:-1]) == []
    assert on_disk(config) == []
    assert rig.send(frame_messages(0)[-1:]) == [0]
    assert on_disk(config) == [0]
    rig.recorder.close()


def test_a_whole_session_with_a_kill_in_the_middle(config: Config) -> None:
    rig = Rig(config)
    for sequence in range(3):
        assert rig.send(frame_messages(sequence)) == [sequence]
    rig.send(frame_messages(3)[:5])
    # kill -9 here: nothing is closed, and the successor gets the unanswered frame again, and an answered one too.
    rig = Rig(config)
    assert rig.recorder.sequence == 2
    assert rig.send(frame_messages(2)) == [2]
    assert rig.send(frame_messages(3)) == [3]
    assert rig.send(end_messages(4)) == [4]
    assert rig.recorder.ended
    with SessionFile(config.run.out / "session.mcap") as file:
        messages = [message for message in file.messages() if message.sequence < 4]
    assert messages == [message for sequence in range(4) for message in recorded_frame(sequence)]
    assert sorted(path.name for path in config.run.out.iterdir()) == ["session.mcap"]
    rig.recorder.close()


def test_one_that_was_killed_behind_the_end_answers_the_end_again(config: Config) -> None:
    rig = Rig(config)
    rig.send(frame_messages(0))
    rig.send(end_messages(1))
    rig = Rig(config)
    assert rig.send(end_messages(1)[:1]) == [1]
    assert rig.recorder.ended
    rig.recorder.close()
    with SessionFile(config.run.out / "session.mcap") as file:
        assert file.message_counts()["camera/end"] == 1


def test_bytes_that_are_no_manifest_and_other_sessions_do_no_harm(config: Config) -> None:
    rig = Rig(config)
    bad = Message(topics.MANIFEST, Envelope(SESSION, 0, 1), b"\xff\xff\xff")
    other = Message(topics.MANIFEST, Envelope("another", 0, 1), payload(topics.MANIFEST, 0))
    impossible = [Message(topics.IMAGE, Envelope(SESSION, *numbers), b"") for numbers in [(-1, 5), (0, -5), (2**32, 5)]]
    assert rig.send([bad, other, *impossible]) == []
    assert rig.send(frame_messages(0)) == [0]
    metrics = rig.recorder.metrics()
    assert (metrics["messages_unreadable"], metrics["other_session"], metrics["frames"]) == (4.0, 1.0, 1.0)
    rig.recorder.close()


def test_realtime_keeps_what_was_incomplete_when_it_ends(config: Config) -> None:
    config = config.model_copy(update={"delivery": config.delivery.model_copy(update={"mode": "realtime"})})
    rig = Rig(config)
    rig.send(frame_messages(0)[:6])
    rig.send(frame_messages(1))
    rig.send(frame_messages(2)[:3])
    rig.recorder.close()
    with SessionFile(config.run.out / "session.mcap") as file:
        assert file.message_counts()["camera/image"] == 3
        assert file.session == SESSION
        assert file.config["delivery"]["mode"] == "realtime"
