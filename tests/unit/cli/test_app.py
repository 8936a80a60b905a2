# SPDX-License-Identifier: Apache-2.0
"""The command line when something is wrong: one line on standard error, an exit code, nothing lost."""

import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.cli.run import resolve_run
from services.runtime.session_file import SessionFile
from tests.command_line import Ended, run_kinemap

Kinemap = Callable[..., Ended]


@pytest.fixture
def kinemap(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Kinemap:
    """Runs `kinemap ARGUMENTS` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: str | Path) -> Ended:
        return run_kinemap(monkeypatch, capsys, *arguments)

    return run


def _one_line(ended: Ended, *parts: str, code: int = 2) -> None:
    assert ended.code == code, ended
    assert ended.err.startswith("kinemap: error: "), ended.err
    assert ended.err.count("\n") == 1, ended.err
    for part in parts:
        assert part in ended.err, ended.err


def _images(folder: Path, count: int = 4) -> Path:
    folder.mkdir(parents=True)
    for index in range(count):
        cv2.imwrite(str(folder / f"{index:06d}.png"), np.full((48, 64), 40 * index, np.uint8))
    return folder


def _kitti(folder: Path, calibration: str = "P0: 50 0 32 0 0 50 24 0 0 0 1 0\n") -> Path:
    _images(folder / "image_0")
    (folder / "calib.txt").write_text(calibration)
    (folder / "times.txt").write_text("".join(f"{0.1 * index}\n" for index in range(4)))
    return folder


@pytest.mark.parametrize(
    "command", ["run", "up", "down", "status", "record", "replay", "export", "evaluate", "config", "doctor"]
)
def test_every_command_explains_itself(kinemap: Kinemap, command: str) -> None:
    ended = kinemap(command, "--help")
    assert ended.code == 0
    assert "Usage: kinemap" in ended.out


def test_an_input_that_is_not_there(kinemap: Kinemap) -> None:
    _one_line(kinemap("run", "/no/such/folder"), "/no/such/folder", "expected a KITTI odometry folder")
    assert not Path("runs").exists()


def test_an_empty_folder(kinemap: Kinemap) -> None:
    Path("empty").mkdir()
    _one_line(kinemap("run", "empty"), "the folder is empty")


def test_a_calibration_with_eleven_numbers(kinemap: Kinemap) -> None:
    folder = _kitti(Path("k"), "P0: 50 0 32 0 0 50 24 0 0 0 1\n")
    _one_line(kinemap("run", folder), "calib.txt", "11", "12")


def test_an_image_of_another_size(kinemap: Kinemap) -> None:
    folder = _kitti(Path("k"))
    cv2.imwrite(str(folder / "image_0" / "000002.png"), np.zeros((50, 64), np.uint8))
    _one_line(kinemap("run", folder), "000002.png", "64x50", "64x48")


def test_a_folder_that_holds_something_is_never_written_to(kinemap: Kinemap) -> None:
    folder = _kitti(Path("k"))
    Path("out").mkdir()
    Path("out/mine.txt").write_text("precious")
    _one_line(kinemap("run", folder, "--out", "out"), "out: the folder is not empty")
    assert [path.name for path in Path("out").iterdir()] == ["mine.txt"]


def test_a_port_in_use_is_said_before_anything_is_written(kinemap: Kinemap) -> None:
    folder = _kitti(Path("k"))
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        _one_line(kinemap("run", folder, "--port", str(port)), f"port {port} on 127.0.0.1 is in use")
    assert not Path("runs").exists()


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("run", "--stage", "parked"), ("slam.stage", "'parked'")),
        (("run", "--set", "slam"), ("expected SECTION.FIELD=VALUE",)),
        (("run", "--config", "none.toml"), ("none.toml", "cannot be read")),
        (("run", "--frames", "0"), ("camera.max_frames",)),
        (("config", "dump", "--set", "delivery.window=0"), ("delivery.window", "greater than or equal to 1")),
        (("replay", "none.mcap"), ("none.mcap: no such file",)),
        (("replay", "none.mcap", "--speed", "nan"), ("--speed nan: expected a number above 0",)),
        (("export", "nowhere"), ("nowhere: no run here",)),
        (("run", "rtsp://me:secret@camera/1", "--set", "delivery.mode=lossless"), ("rtsp://...@camera/1", "realtime")),
        (("run", "/dev/video97"), ("camera /dev/video97: gives no frame",)),
        (("status",), ("no run in",)),
        (("down",), ("no run in",)),
        (("record", "x", "--bus"), ("expected either an input or --bus",)),
    ],
)
def test_wrong_arguments(kinemap: Kinemap, arguments: tuple[str, ...], parts: tuple[str, ...]) -> None:
    _one_line(kinemap(*arguments), *parts)


def test_a_live_camera_is_realtime_unless_it_is_asked_for_otherwise(tmp_path: Path) -> None:
    resolved = resolve_run(None, None, {"camera": {"input": "rtsp://camera/1"}}, tmp_path / "live")
    assert (resolved.delivery.mode, resolved.camera.input) == ("realtime", "rtsp://camera/1")
    folder = resolve_run(None, None, {"camera": {"input": str(tmp_path)}}, tmp_path / "folder")
    assert folder.delivery.mode == "lossless"


@pytest.mark.parametrize("address", ["http://127.0.0.1:9/nothing", "/dev/video97"])
def test_a_camera_that_cannot_be_reached_is_one_line_of_ours(address: str) -> None:
    # A process of its own: FFmpeg and V4L2 write past Python's standard error.
    command = [sys.executable, "-m", "services.cli.app", "run", address]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"kinemap: error: camera {address}: gives no frame")
    assert ended.stderr.count("\n") == 1


def test_run_names_every_kind_of_input(kinemap: Kinemap) -> None:
    said = " ".join(kinemap("run", "--help").out.replace("│", " ").split())
    kinds = "KITTI, raw, tracking, TUM, EuRoC, ROS 1, ROS 2, MCAP, Foxglove, rtsp://, /dev/video0, 'simulator'"
    assert [kind for kind in kinds.split(", ") if kind not in said] == []


def test_an_unknown_flag_is_one_of_the_parser(kinemap: Kinemap) -> None:
    assert kinemap("run", "--nonsense").code == 2
    assert kinemap("nonsense").code == 2


def test_record_writes_a_whole_session_and_overwrites_none(kinemap: Kinemap) -> None:
    folder = _kitti(Path("k"))
    ended = kinemap("record", folder, "--file", "a/b.mcap")
    assert (ended.code, ended.out) == (0, "a/b.mcap: 13 messages\n")
    with SessionFile(Path("a/b.mcap")) as session:
        counts = session.message_counts()
    assert counts == {"camera/calibration": 4, "camera/end": 1, "camera/image": 4, "camera/manifest": 4}
    before = Path("a/b.mcap").read_bytes()
    _one_line(kinemap("record", folder, "--file", "a/b.mcap"), "exists, expected the name of a new file")
    assert Path("a/b.mcap").read_bytes() == before


def test_a_recording_that_was_cut_off(kinemap: Kinemap) -> None:
    kinemap("record", _kitti(Path("k")), "--file", "whole.mcap")
    data = Path("whole.mcap").read_bytes()
    Path("cut.mcap").write_bytes(data[: int(0.6 * len(data))])
    for command in (("replay", "cut.mcap"), ("run", "cut.mcap"), ("replay", "cut.mcap", "--camera")):
        _one_line(kinemap(*command), "cut.mcap")
    assert len(Path("cut.mcap").read_bytes()) == int(0.6 * len(data))


def test_a_topic_that_was_not_recorded(kinemap: Kinemap) -> None:
    kinemap("record", _kitti(Path("k")), "--file", "a.mcap")
    _one_line(kinemap("replay", "a.mcap", "--topic", "slam/pose"), "slam/pose: not in a.mcap", "camera/image")


def test_brackets_are_printed_as_they_are(kinemap: Kinemap) -> None:
    folder = _kitti(Path("[red]k"))
    assert kinemap("record", folder, "--file", "[bold].mcap").out == "[bold].mcap: 13 messages\n"
    _one_line(kinemap("run", "[red]none"), "[red]none")


def test_the_dump_can_be_given_back(kinemap: Kinemap) -> None:
    first = kinemap("config", "dump", "--set", "slam.stage=base")
    Path("c.toml").write_text(first.out)
    again = kinemap("config", "dump", "--config", "c.toml")
    assert again.code == 0
    assert 'stage = "base"' in again.out
    assert [line for line in again.out.splitlines() if not line.startswith("#")] == [
        line for line in first.out.splitlines() if not line.startswith("#")
    ]
