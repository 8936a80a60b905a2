# SPDX-License-Identifier: Apache-2.0
"""A benchmark's runs as the processes that they are."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from services.cli.app import main
from services.cli.bench.child_run import ChildRun, ProcessRunner
from services.cli.bench.plan import BenchRequest, PlannedRun, plan_runs, stage_variants

LIMIT_S = 120.0
SMALL_STREET = ("simulator.width=480", "simulator.height=144", "simulator.empty_start_m=0.0")


def _planned(source: str, *settings: str, frames: int = 8) -> PlannedRun:
    request = BenchRequest((source,), stage_variants("base"), frames=frames, settings=settings)
    return plan_runs(request)[0]


def _children(folder: Path) -> list[psutil.Process]:
    found = []
    for process in psutil.process_iter(["cmdline"]):
        if str(folder) in " ".join(process.info["cmdline"] or []):
            found.append(process)
    return found


def test_a_run_that_fails_is_told_in_its_own_one_line(tmp_path: Path) -> None:
    running = ProcessRunner().start(_planned(str(tmp_path / "none")), tmp_path / "bench" / "run")
    end = running.wait(LIMIT_S)
    assert end is not None
    assert end.failure.startswith(f"input {tmp_path / 'none'}: no such file or folder; expected")
    assert "\n" not in end.failure
    assert end.wall_s > 0.0


def test_a_variant_is_not_overridden_by_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planned = _planned(str(tmp_path / "none"))
    monkeypatch.setenv("KINEMAP_CAMERA__INPUT", str(tmp_path / "another"))
    monkeypatch.setenv("KINEMAP_SLAM__STAGE", "nonsense")
    end = ProcessRunner().start(planned, tmp_path / "run").wait(LIMIT_S)
    assert end is not None
    assert f"input {tmp_path / 'none'}: no such" in end.failure


def test_the_share_done_is_read_from_what_the_run_last_said(tmp_path: Path) -> None:
    running = ChildRun(tmp_path / "none.toml", tmp_path / "run")
    assert running.wait(LIMIT_S) is not None
    log = tmp_path / "run.log"
    for text, share in (
        ("", 0.0),
        ("0/? frames, 0.0 fps\n", 0.0),
        ("0/40 frames, 0.0 fps\n10/40 frames, 8.3 fps\n", 0.25),
        ("40/40 frames, 8.3 fps\n" + "x" * 1000, 0.95),
    ):
        log.write_text(text)
        assert running.share_done() == share


@pytest.mark.real_processes
def test_the_command_runs_the_pipeline_and_then_has_nothing_left_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    settings = [word for setting in SMALL_STREET for word in ("--set", setting)]
    arguments = ["bench", "--stages", "moving", "--seeds", "3", "--frames", "20", "--out", str(tmp_path / "bench")]
    for first in (True, False):
        monkeypatch.setattr(sys, "argv", ["kinemap", *arguments, *settings])
        with pytest.raises(SystemExit) as ended:
            main()
        out = capsys.readouterr().out
        assert ended.value.code in (0, None), out
        assert ("1 of 1 runs are there already" in out) is not first
        assert "coverage, median (least)" in out
    (run,) = json.loads((tmp_path / "bench" / "bench.json").read_text())["runs"]
    assert run["failure"] == ""
    assert run["measures"]["frames"] == 20
    report = json.loads((tmp_path / "bench" / run["folder"] / "report.json").read_text())
    assert report["stage"] == "moving"
    assert "seed 3" in report["input"]
    assert _children(tmp_path) == []


@pytest.mark.real_processes
def test_no_run_outlives_a_benchmark_that_is_killed(tmp_path: Path) -> None:
    program = (
        "from pathlib import Path\n"
        "from services.cli.bench.child_run import ProcessRunner\n"
        "from services.cli.bench.plan import BenchRequest, plan_runs, stage_variants\n"
        f"plan = plan_runs(BenchRequest(variants=stage_variants('base'), settings={SMALL_STREET}))\n"
        f"ProcessRunner().start(plan[0], Path({str(tmp_path / 'run')!r}))\n"
        "print('started', flush=True)\n"
        "input()\n"
    )
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as killed:
        assert killed.stdout is not None
        assert killed.stdout.readline() == b"started\n"
        (child,) = psutil.Process(killed.pid).children()
        os.kill(killed.pid, signal.SIGKILL)
        child.wait(LIMIT_S)
    assert _children(tmp_path) == []
