# SPDX-License-Identifier: Apache-2.0
"""`kinemap simulate` as a user types it."""

import contextlib
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.cli.simulate_seeds import parse_seeds, parse_size
from services.runtime.errors import InputError
from tests.command_line import Ended, run_kinemap

pytest.importorskip("pycocotools")

TINY = ("--size", "96x64", "--frames", "6", "--set", "simulator.empty_start_m=0")


Simulate = Callable[..., Ended]


@pytest.fixture
def simulate(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Simulate:
    """Runs `kinemap simulate ARGUMENTS` in an empty folder, in this process."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NO_COLOR", "1")
    before = signal.getsignal(signal.SIGTERM)

    def run(*arguments: str | Path) -> Ended:
        try:
            return run_kinemap(monkeypatch, capsys, "simulate", *arguments)
        finally:
            signal.signal(signal.SIGTERM, before)

    return run


def _one_line(ended: Ended, *parts: str) -> None:
    assert ended.code == 2, ended
    assert ended.err.startswith("kinemap: error: "), ended.err
    assert ended.err.count("\n") == 1, ended.err
    for part in parts:
        assert part in ended.err, ended.err


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ((), ("expected either --out DIR", "--sheet")),
        (("--out", "d", "--sheet", "s.jpg"), ("expected either --out DIR",)),
        (("--out", "d", "--seed", "1", "--seeds", "2"), ("--seed 1 and --seeds 2", "expected one")),
        (("--out", "d", "--seeds", "1,x"), ("--seeds 1,x", "such as 1,2,5-8")),
        (("--out", "d", "--seeds", "5-2"), ("--seeds 5-2", "such as 1,2,5-8")),
        (("--out", "d", "--seeds", "1,1"), ("seed 1 stands there twice",)),
        (("--out", "d", "--size", "96"), ("--size 96", "expected WIDTHxHEIGHT")),
        (("--out", "d", "--size", "96x7"), ("height = 7", "32")),
        (("--out", "d", "--size", "96x9999"), ("height=9999", "expected 32")),
        (("--out", "d", "--world", "moon"), ("moon",)),
        (("--out", "d", "--frames", "0"), ("frames",)),
        (("--out", "d", "--rate", "nan"), ("rate_hz",)),
        (("--out", "d", "--formats", "kitti,rosbag"), ("'rosbag'", "expected some of kitti")),
        (("--out", "d", "--set", "slam.stage=base"), ("--set slam", "expected simulator.FIELD=VALUE")),
        (("--out", "d", "--set", "simulator.wheels=3"), ("simulator.wheels",)),
        (("--sheet", "sheet.bmp"), ("sheet.bmp", "ends in .jpg")),
        (("--sheet", "sheet.jpg", "--frames", "1"), ("frames=1", "expected at least 2")),
    ],
)
def test_what_cannot_be_used_is_one_line_and_writes_nothing(
    simulate: Simulate, tmp_path: Path, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    _one_line(simulate(*arguments), *parts)
    assert list(tmp_path.iterdir()) == []


def test_makes_a_data_set_and_then_has_nothing_to_do(simulate: Simulate, tmp_path: Path) -> None:
    ended = simulate("--out", "set", "--seeds", "3", "--jobs", "1", "--formats", "tum,instances", *TINY)
    assert ended.code == 0, ended
    assert ended.out == "set\n"
    assert "complete: 6 frames, 6 of them rendered" in ended.err
    assert len(list((tmp_path / "set/sequences/00/image_2").glob("*.png"))) == 6
    again = simulate("--out", "set", "--seeds", "3", "--jobs", "2", "--formats", "tum,instances", *TINY)
    assert again.code == 0
    assert "nothing to do" in again.err
    _one_line(simulate("--out", "set", "--seeds", "4", "--formats", "tum,instances", *TINY), "seeds=3", "is 4")


@pytest.mark.real_processes
def test_goes_on_after_kill_9_and_after_ctrl_c(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    command = [sys.executable, "-m", "services.cli.app", "simulate", "--out", str(folder), "--jobs", "2", "--seed", "3"]
    command += ["--size", "96x64", "--frames", "80", "--formats", "tum"]
    records = folder / ".progress" / "00"

    def begun(at_least: int) -> subprocess.Popen[str]:
        process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        while process.poll() is None and len(list(records.glob("0*.json"))) < at_least:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.02)
        assert process.poll() is None
        return process

    killed = begun(2)
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    after_kill = {path.name: path.stat().st_mtime_ns for path in (folder / "sequences/00/image_2").glob("0*.png")}
    interrupted = begun(len(after_kill) + 2)
    interrupted.send_signal(signal.SIGINT)
    _, said = interrupted.communicate()
    assert interrupted.returncode == 130
    assert "the same command goes on" in said
    assert "Traceback" not in said
    assert f"of 80 frames are in {folder}" in said
    last = subprocess.run(command, capture_output=True, text=True, check=False)
    assert last.returncode == 0, last
    assert "going on: " in last.stderr
    images = {path.name: path for path in (folder / "sequences/00/image_2").iterdir()}
    assert len(images) == 80
    kept = [name for name, time_ns in after_kill.items() if images[name].stat().st_mtime_ns == time_ns]
    assert len(kept) >= 2
    assert all(cv2.imread(str(path)) is not None for path in images.values())


def test_draws_a_sheet(simulate: Simulate, tmp_path: Path) -> None:
    ended = simulate("--sheet", "docs/sheet.jpg", "--seeds", "3,4", *TINY)
    assert ended.code == 0, ended
    picture = cv2.imread(str(tmp_path / "docs/sheet.jpg"))
    assert picture is not None
    assert picture.shape[1] <= 2500
    rows = picture[40:, 80:].reshape(-1, 3).astype(np.int64)
    assert len(np.unique(rows // 32, axis=0)) > 30


def test_explains_itself(simulate: Simulate) -> None:
    ended = simulate("--help")
    assert ended.code == 0
    assert "Usage: kinemap simulate" in ended.out
    assert "--formats" in ended.out


def test_seeds_and_sizes_are_read_as_meant() -> None:
    assert parse_seeds("7") == (7,)
    assert parse_seeds("1, 2,5-8") == (1, 2, 5, 6, 7, 8)
    assert parse_size("1242x375") == (1242, 375)
    for text in ("", "1,,2", "-3", "1-9999", "1.5"):
        with pytest.raises(InputError, match="--seeds"):
            parse_seeds(text)
    for text in ("1242", "x375", "1242X375x3", "-5x7"):
        with pytest.raises(InputError, match="--size"):
            parse_size(text)
