# SPDX-License-Identifier: Apache-2.0
"""A session replayed onto a real bus, and recorded from there again."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import EndOfInput, FrameManifest, Heartbeat, TruePose
from schemas.topics import Topic
from services.cli.ports import any_free_port
from services.cli.record import messages_of_bus
from services.recorder.session_writer import SessionWriter
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.session_file import RecordedMessage, SessionFile

RECORDED = [topic for topic in topics.TOPICS if topic.recorded]


def _session(path: Path, frames: int = 5) -> list[RecordedMessage]:
    messages = []
    for sequence in range(frames):
        time_ns = 1_000_000_000 + sequence * 20_000_000
        for topic, record in (
            (topics.MANIFEST, FrameManifest(time_ns, "made up", str(sequence), (topics.TRUE_POSE.key,), frames)),
            (topics.TRUE_POSE, TruePose(time_ns, np.eye(4))),
        ):
            messages.append(RecordedMessage(topic.key, sequence, time_ns, encode(topic, record)))
    end = EndOfInput(2_000_000_000, frames)
    messages.append(RecordedMessage(topics.END.key, frames, end.timestamp_ns, encode(topics.END, end)))
    writer = SessionWriter(path, "made-up")
    writer.append(messages)
    writer.finish()
    writer.close()
    return messages


def _start(*arguments: str, port: int) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-u", "-m", "services.cli.app", *arguments],
        env={**os.environ, "KINEMAP_BUS__ENTRY_POINT": f"tcp/127.0.0.1:{port}"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@pytest.mark.real_processes
def test_what_is_replayed_is_recorded_again_byte_for_byte(tmp_path: Path) -> None:
    messages = _session(tmp_path / "a.mcap")
    port = any_free_port()
    recording = _start("record", "--bus", "--file", str(tmp_path / "b.mcap"), port=port)
    try:
        assert recording.stdout is not None
        assert recording.stdout.readline().startswith("listening on tcp/127.0.0.1")
        replaying = _start("replay", str(tmp_path / "a.mcap"), port=port)
        said, _ = replaying.communicate(timeout=60)
        assert replaying.returncode == 0, said
        assert said == f"done: {len(messages)} messages of session made-up\n"
        assert recording.wait(timeout=60) == 0
    finally:
        recording.kill()
        recording.wait()
    with SessionFile(tmp_path / "b.mcap") as session:
        assert session.session == "made-up"
        # Between topics the bus keeps no order: compared as sets.
        assert sorted(session.messages()) == sorted(messages)


@pytest.mark.real_processes
def test_ctrl_c_leaves_a_recording_that_is_whole(tmp_path: Path) -> None:
    _session(tmp_path / "a.mcap")
    port = any_free_port()
    recording = _start("record", "--bus", "--file", str(tmp_path / "b.mcap"), port=port)
    try:
        assert recording.stdout is not None
        recording.stdout.readline()
        keys = ("--topic", topics.MANIFEST.key)
        replaying = _start("replay", str(tmp_path / "a.mcap"), *keys, port=port)
        assert replaying.wait(timeout=60) == 0
        recording.send_signal(signal.SIGINT)
        assert recording.wait(timeout=60) == 0
    finally:
        recording.kill()
        recording.wait()
    with SessionFile(tmp_path / "b.mcap") as session:
        assert session.message_counts() == {topics.MANIFEST.key: 5}


def test_only_one_session_is_recorded_and_its_end_ends_it() -> None:
    bus = FakeBus(FakeNetwork())
    subscription = bus.subscribe(RECORDED)

    def say(topic: Topic, record: object, session: str, sequence: int) -> None:
        bus.publish(topic, encode(topic, record), Envelope(session, sequence, sequence))

    say(topics.TRUE_POSE, TruePose(0, np.eye(4)), "first", 0)
    say(topics.TRUE_POSE, TruePose(1, np.eye(4)), "second", 1)
    say(topics.END, EndOfInput(1, 1), "second", 1)
    say(topics.HEARTBEAT, Heartbeat("slam", 1, "done", 0, 0), "first", 0)
    say(topics.END, EndOfInput(2, 1), "first", 1)
    heard = [m for m in messages_of_bus(subscription, load_config(), threading.Event()) if m is not None]
    assert {session for session, _ in heard} == {"first"}
    assert [(message.key, message.sequence) for _, message in heard] == [(topics.TRUE_POSE.key, 0), (topics.END.key, 1)]
