# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis odometry` on played runs with known errors."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.cli.bench.child_run import RunEnd, RunningRun
from services.cli.bench.drive import FailedRunsError
from services.cli.bench.plan import BenchRequest, PlannedRun, plan_runs, stage_variants
from services.cli.bench.results import BenchOutput
from services.cli.thesis.odometry import make_tables
from services.formats.png import write_png
from services.formats.trajectory import Trajectory
from services.formats.tum import write_tum

FRAMES = 30
NOISE_M = {"base": 0.4, "moving": 0.1}


class _Played:
    def __init__(self, end: RunEnd) -> None:
        self._end = end

    def wait(self, timeout_s: float) -> RunEnd:
        return self._end

    def share_done(self) -> float:
        return 1.0

    def stop(self) -> None:
        """It has ended."""


class PlayedRunner:
    """Writes what a run leaves: its report, its path and the true one."""

    def __init__(self, failing: str = "") -> None:
        self.seeds: list[tuple[int, int]] = []
        self._failing = failing

    def start(self, run: PlannedRun, folder: Path) -> RunningRun:
        assert run.configuration["camera"]["stereo"] is False
        self.seeds.append((run.configuration["slam"]["seed"], run.configuration["motion"]["seed"]))
        if run.name == self._failing:
            return _Played(RunEnd("killed", 1.0))
        folder.mkdir(parents=True)
        times = np.arange(FRAMES, dtype=np.int64) * 100_000_000
        true = np.tile(np.eye(4), (FRAMES, 1, 1))
        true[:, 2, 3] = np.arange(FRAMES)
        true[:, 0, 3] = 4.0 * np.sin(np.arange(FRAMES) / 5.0)
        noisy = true.copy()
        rng = np.random.default_rng(run.configuration["slam"]["seed"])
        noisy[:, :3, 3] += rng.normal(0.0, NOISE_M[run.variant], (FRAMES, 3))
        write_tum(Trajectory(times, true, "truth"), folder / "ground_truth.tum")
        write_tum(Trajectory(times, noisy, "estimate"), folder / "trajectory.tum")
        ate_m = NOISE_M[run.variant] + 0.001 * run.configuration["slam"]["seed"]
        (folder / "report.json").write_text(json.dumps(_report(ate_m)))
        return _Played(RunEnd("", 1.0))


def _report(ate_m: float) -> dict[str, Any]:
    return {
        "version": 1,
        "failure": "",
        "frames": {"in": FRAMES, "expected": FRAMES, "tracked": FRAMES},
        "ate": {"final": {"coverage": 1.0, "ate_m": {"rmse": ate_m}}},
        "moving_flag": None,
        "landmarks": {},
        "density_frames": {},
        "frames_per_s": 8.0,
        "services": {},
    }


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """Sequences 04 (with masks) and 05 (without) of KITTI's layout."""
    for name in ("04", "05"):
        images = tmp_path / "kitti" / "sequences" / name / "image_0"
        images.mkdir(parents=True)
        for number in range(2):
            write_png(images / f"{number:06d}.png", np.zeros((40, 60), dtype=np.uint8))
        (images.parent / "calib.txt").write_text("P0: 50 0 30 0 0 50 20 0 0 0 1 0\n")
        (tmp_path / "kitti" / "poses").mkdir(exist_ok=True)
        (tmp_path / "kitti" / "poses" / f"{name}.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * 2)
    (tmp_path / "kitti" / "sequences" / "04" / "instances").mkdir()
    (tmp_path / "kitti" / "sequences" / "04" / "instances" / "instances.json").write_text("{}")
    return tmp_path / "kitti"


Play = Callable[..., PlayedRunner]


@pytest.fixture
def play(data: Path, tmp_path: Path) -> Play:
    """Plays two trials of both stages on 04 into out/."""
    inputs = (str(data / "sequences" / "04"),)
    request = BenchRequest(inputs, stage_variants("base,moving"), repeat=2, settings=("camera.stereo=false",))

    def run(runner: PlayedRunner, frames: int | None = None) -> PlayedRunner:
        (tmp_path / "out").mkdir(exist_ok=True)
        make_tables(plan_runs(request), BenchOutput(tmp_path / "out", Path(), "kinemap"), frames, runner=runner)
        return runner

    return run


def test_tables_and_figures_of_the_thesis(play: Play, tmp_path: Path) -> None:
    runner = play(PlayedRunner())
    # a trial differs from the last by its seeds alone
    assert runner.seeds == [(1, 20), (1, 20), (2, 21), (2, 21)]
    text = (tmp_path / "out" / "odometry.md").read_text()
    assert "| 04 | 1.620 | 0.970 | 1.009 | 1.250 | 0.402 | 0.102 |" in text
    assert "| 04 | 0.101 | 0.102 | 0.102 | 100.0% |" in text
    for picture in ("bars.png", "top-04.png", "axes-04.png", "errors.png"):
        assert f"({picture})" in text
        assert (tmp_path / "out" / picture).stat().st_size > 0
    found = json.loads((tmp_path / "out" / "odometry.json").read_text())
    assert found["rows"][1]["average_m"] == pytest.approx(0.1015)


def test_it_goes_on_where_it_was_and_runs_nothing_twice(play: Play) -> None:
    with pytest.raises(FailedRunsError):
        play(PlayedRunner(failing="04 moving repeat-2"))
    assert play(PlayedRunner()).seeds == [(2, 21)]
    assert play(PlayedRunner()).seeds == []


def test_a_failed_trial_does_not_take_the_tables_with_it(play: Play, tmp_path: Path) -> None:
    with pytest.raises(FailedRunsError):
        play(PlayedRunner(failing="04 moving repeat-2"))
    assert "| 04 | 0.101 | failed | 0.101 (1 of 2) | 100.0% |" in (tmp_path / "out" / "odometry.md").read_text()


def test_beside_a_part_of_a_sequence_nothing_published_stands(play: Play, tmp_path: Path) -> None:
    play(PlayedRunner(), frames=FRAMES)
    text = (tmp_path / "out" / "odometry.md").read_text()
    assert "| 04 | - | - | - | - | 0.402 | 0.102 |" in text
    assert f"The first {FRAMES} frames alone" in text


@pytest.mark.usefixtures("without_network")
@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--data", "nowhere"), ("--data nowhere: no such folder",)),
        (("--data", "kitti", "--sequences", "07"), ("no sequences/07 with image_0",)),
        (("--data", "kitti", "--sequences", "04,"), ("--sequences 04,: expected",)),
        (("--data", "kitti", "--sequences", "05"), ("no instances/ for stage dynamic", "--stages base")),
        (("--data", "kitti", "--sequences", "04", "--stages", "fast"), ("'fast' is no stage",)),
        (("--data", "kitti", "--sequences", "04", "--set", "slam.features=1"), ("slam.features = 1",)),
        (("--data", "kitti", "--sequences", "04", "--out", "kitti"), ("no benchmark's folder",)),
    ],
)
def test_bad_input_is_one_line_and_runs_nothing(
    data: Path, kinemap: Any, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    kinemap("thesis", "odometry", "--out", "out", *arguments).is_one_line(*parts)
    assert not (data.parent / "out").exists()


def test_a_sequence_without_true_poses_is_refused(data: Path, kinemap: Any) -> None:
    (data / "poses" / "04.txt").unlink()
    ended = kinemap("thesis", "odometry", "--data", "kitti", "--sequences", "04", "--out", "out")
    ended.is_one_line("poses/04.txt: no such file, expected the true poses")
