# SPDX-License-Identifier: Apache-2.0
"""`kinemap record INPUT`: a camera that falls silent is left at once, and a bad frame loses nothing before it."""

import os
import signal
import threading
from pathlib import Path

import cv2
import numpy as np
import pytest

from schemas import topics
from schemas.codec import decode
from schemas.records import CameraCalibration, Image
from services.camera import configured_source
from services.camera.sources.source import SourceFrame
from services.cli.pipeline_run import InterruptedRunError
from services.cli.record import messages_of_input, record
from services.runtime.config import load_config
from services.runtime.errors import InputError
from services.runtime.session_file import SessionFile


class FallsSilent:
    """A live camera: one frame, then none until it is closed."""

    name, frame_count, rate_hz = "camera test", -1, 30.0
    notes: tuple[str, ...] = ()

    def __init__(self) -> None:
        self.asked_again, self.closed = threading.Event(), threading.Event()

    def frame(self, index: int) -> SourceFrame | None:
        if index:
            self.asked_again.set()
            self.closed.wait()
            return None
        calibration = CameraCalibration(5, 4, 3, np.eye(3))
        return SourceFrame("000000", 5, Image(5, np.zeros((3, 4), np.uint8)), calibration)

    def close(self) -> None:
        self.closed.set()


@pytest.mark.timeout(30)
def test_a_silent_camera_is_left_when_told_to_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    camera, stop = FallsSilent(), threading.Event()
    monkeypatch.setattr(configured_source, "open_configured_source", lambda _: camera)
    keys = []
    for message in messages_of_input(load_config(None, {"camera": {"input": "0"}}), stop):
        if message is not None:
            keys.append(message[1].key)
        if topics.CALIBRATION.key in keys and camera.asked_again.wait(10):
            stop.set()
    assert keys[0] == topics.MANIFEST.key
    assert set(keys) == {topic.key for topic in (topics.MANIFEST, topics.IMAGE, topics.CALIBRATION, topics.END)}
    assert camera.closed.is_set()


def _folder(path: Path, frames: int) -> Path:
    path.mkdir()
    random = np.random.default_rng(1)
    for index in range(frames):
        cv2.imwrite(str(path / f"{index:03d}.png"), random.integers(0, 256, (24, 32), dtype=np.uint8))
    (path / "calibration.toml").write_text("fx = 20\nfy = 20\ncx = 16\ncy = 12\nwidth = 32\nheight = 24\n")
    return path


def _keep_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the command sets for its process stays out of the tests'."""
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr("services.cli.record.set_up_logging", lambda _: None)


def test_what_came_before_a_broken_image_is_recorded_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    folder = _folder(tmp_path / "drive", 4)
    broken = folder / "002.png"
    broken.write_bytes(broken.read_bytes()[:200])
    file = tmp_path / "a.mcap"
    _keep_process(monkeypatch)
    with caplog.at_level("WARNING"), pytest.raises(InputError, match=f"image {broken}: not a readable image"):
        record(str(folder), file, settings=["run.session=made-up"])
    with SessionFile(file) as session:
        assert not session.recovered
        assert session.message_counts()[topics.IMAGE.key] == 2
        (end,) = session.messages([topics.END.key])
        assert decode(topics.END, end.payload).frame_count == 2
    assert [entry.fields["note"] for entry in caplog.records if entry.message == "assumed"] == [  # type: ignore[attr-defined]
        "no times.txt in drive: times are assumed at 10 Hz"
    ]


def test_a_name_that_is_no_text_is_recorded_as_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = _folder(tmp_path / "drive", 1)
    (folder / "000.png").rename(os.fsdecode(os.fsencode(folder) + b"/\xff7.png"))
    _keep_process(monkeypatch)
    record(str(folder), tmp_path / "a.mcap", settings=["run.session=made-up"])
    with SessionFile(tmp_path / "a.mcap") as session:
        (manifest,) = session.messages([topics.MANIFEST.key])
        assert decode(topics.MANIFEST, manifest.payload).frame_name == "\ufffd7"


def test_a_camera_left_before_its_first_frame_records_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    camera = FallsSilent()
    monkeypatch.setattr(configured_source, "open_configured_source", lambda _: camera)
    _keep_process(monkeypatch)
    # Ctrl-C comes while the camera is being opened.
    monkeypatch.setattr(signal, "signal", lambda _, handler: handler())
    with pytest.raises(InterruptedRunError, match="nothing was recorded") as ended:
        record("0", tmp_path / "a.mcap")
    assert ended.value.exit_code == 130
    assert camera.closed.is_set()
    assert not (tmp_path / "a.mcap").exists()
