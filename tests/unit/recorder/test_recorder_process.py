# SPDX-License-Identifier: Apache-2.0
"""The recorder as a process on a real bus, killed in the middle: nothing that it answered is lost."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import tomli_w

from schemas import topics
from services.cli.ports import any_free_port
from services.runtime.bus import Message
from services.runtime.config import Config, dump_config, load_config
from services.runtime.session_file import SessionFile
from services.runtime.zenoh_bus import ZenohBus, open_session
from tests.unit.recorder.recorded_frames import SESSION, end_messages, frame_messages, recorded_frame

pytestmark = pytest.mark.real_processes
ROOT = Path(__file__).resolve().parents[3]
PATIENCE_S = 20.0


@pytest.fixture
def config(tmp_path: Path) -> Config:
    overrides = {
        "run": {"out": str(tmp_path), "session": SESSION},
        "bus": {"entry_point": f"tcp/127.0.0.1:{any_free_port()}"},
        "recorder": {"reserve_mb": 1},
    }
    config = load_config(overrides=overrides)
    (tmp_path / "config.toml").write_text(tomli_w.dumps(dump_config(config)), encoding="utf-8")
    return config


class Others:
    """The rest of the pipeline: sends frames, hears answers, sees who lives."""

    def __init__(self, bus: ZenohBus) -> None:
        self._bus = bus
        self._answers = bus.subscribe([topics.ANSWER])
        self._changed = threading.Condition()
        self._alive = False
        bus.watch_alive(self._on_change)

    def _on_change(self, _: str, alive: bool) -> None:
        with self._changed:
            self._alive = alive
            self._changed.notify_all()

    def await_recorder(self, *, alive: bool = True) -> None:
        with self._changed:
            assert self._changed.wait_for(lambda: self._alive is alive, PATIENCE_S)

    def send(self, messages: list[Message]) -> None:
        for message in messages:
            self._bus.publish(message.topic, message.payload, message.envelope, message.suffix)

    def deliver(self, frames: dict[int, list[Message]], ended: Callable[[], bool] = lambda: False) -> None:
        """Send frames until all are answered; one that is not is sent again, as the camera and the others do."""
        give_up_s = time.monotonic() + PATIENCE_S
        missing = dict(frames)
        while missing and not ended():
            assert time.monotonic() < give_up_s, f"no answer to {sorted(missing)}"
            for messages in missing.values():
                self.send(messages)
            while missing and (answer := self._answers.receive(1.0)) is not None:
                if answer.suffix == "recorder":
                    missing.pop(answer.envelope.sequence, None)


@pytest.fixture
def others(config: Config) -> Iterator[Others]:
    entry = open_session(config.bus, listen=config.bus.entry_point, connect=False)
    with ZenohBus(config.bus, lossless=True) as bus:
        yield Others(bus)
    entry.close()


def start(config: Config) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "services.recorder.service", "--config", str(config.run.out / "config.toml")]
    return subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE)


def test_killed_in_the_middle(config: Config, others: Others) -> None:
    recorder = start(config)
    others.await_recorder()
    others.deliver({sequence: frame_messages(sequence) for sequence in range(10)})
    others.send(frame_messages(10)[:6])
    os.kill(recorder.pid, signal.SIGKILL)
    recorder.communicate()
    others.await_recorder(alive=False)
    with SessionFile(config.run.out / "session.mcap", recover=True) as file:
        on_disk = [message.sequence for message in file.messages([topics.MANIFEST.key])]
    assert on_disk[:10] == list(range(10))

    recorder = start(config)
    started_s = time.monotonic()
    others.await_recorder()
    assert time.monotonic() - started_s < 5.0
    others.deliver({sequence: frame_messages(sequence) for sequence in range(9, 20)})
    others.deliver({20: end_messages(20)})
    recorder.terminate()
    recorder.communicate(timeout=PATIENCE_S)
    assert recorder.returncode == 0
    with SessionFile(config.run.out / "session.mcap") as file:
        messages = [message for message in file.messages() if message.sequence < 20]
    assert messages == [message for sequence in range(20) for message in recorded_frame(sequence)]


def test_told_to_end_in_the_middle_it_leaves_a_whole_file(config: Config, others: Others) -> None:
    recorder = start(config)
    others.await_recorder()
    others.deliver({0: frame_messages(0)})
    others.send(frame_messages(1)[:4])
    recorder.terminate()
    recorder.communicate(timeout=PATIENCE_S)
    assert recorder.returncode == 0
    with SessionFile(config.run.out / "session.mcap") as file:
        assert list(file.messages()) == recorded_frame(0)


def test_a_file_of_another_session_is_one_line_and_exit_code_2(config: Config) -> None:
    (config.run.out / "session.mcap").write_text("these are somebody's notes")
    recorder = start(config)
    _, said = recorder.communicate(timeout=PATIENCE_S)
    assert recorder.returncode == 2
    assert b"Traceback" not in said
    assert said.decode().splitlines()[-1].endswith("holds something that is no recorded session; choose another folder")


def test_a_full_disk_is_one_line_and_exit_code_2_and_the_file_is_whole(config: Config, others: Others) -> None:
    disk = config.run.out / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1500k", "tmpfs", disk], check=False).returncode != 0:
        pytest.skip("mounting a small disk needs rights that this user does not have")
    config.recorder.file = disk / "session.mcap"
    (config.run.out / "config.toml").write_text(tomli_w.dumps(dump_config(config)), encoding="utf-8")
    recorder = start(config)
    try:
        others.await_recorder()
        for first in range(0, 1000, 20):
            batch = range(first, first + 20)
            others.deliver(
                {sequence: frame_messages(sequence) for sequence in batch}, lambda: recorder.poll() is not None
            )
        _, said = recorder.communicate(timeout=PATIENCE_S)
        assert recorder.returncode == 2
        assert b"Traceback" not in said
        assert "No space left on device; the recording ends here" in said.decode().splitlines()[-1]
        with SessionFile(disk / "session.mcap") as file:
            sequences = [message.sequence for message in file.messages([topics.MANIFEST.key])]
        assert sequences == list(range(len(sequences)))
        assert len(sequences) > 10
    finally:
        recorder.kill()
        recorder.wait()
        subprocess.run(["umount", disk], check=True)
