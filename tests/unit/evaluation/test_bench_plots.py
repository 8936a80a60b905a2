# SPDX-License-Identifier: Apache-2.0
"""A benchmark's pictures and its file."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.evaluation.bench.file import Bench, read_bench, write_bench
from services.evaluation.bench.paths import TRUTH_NAME, read_paths
from services.evaluation.bench.plots import plot_axes, plot_errors, plot_trials
from services.evaluation.bench.runs import BenchRun, RunMeasures
from services.evaluation.run.folder import TRAJECTORY_NAME
from services.evaluation.trajectory.alignment import Similarity
from services.formats.trajectory import Trajectory
from services.formats.tum import write_tum
from services.runtime.errors import InputError

Drive = Callable[..., Trajectory]


@pytest.fixture
def runs(tmp_path: Path, winding_drive: Drive, seen_from_elsewhere: Drive) -> list[BenchRun]:
    """Two variants and two seeds, the noise of each path known; one run was lost."""
    found = []
    for variant, noise_m in (("base", 0.4), ("moving", 0.1)):
        for seed in (7, 13):
            folder = tmp_path / "simulator" / variant / f"seed-{seed}"
            folder.mkdir(parents=True)
            truth = winding_drive()
            write_tum(truth, folder / TRUTH_NAME)
            estimate = seen_from_elsewhere(truth, Similarity(np.eye(3), np.ones(3), 2.0), noise_m, seed)
            write_tum(estimate, folder / TRAJECTORY_NAME)
            coverage = 0.5 if (variant, seed) == ("base", 13) else 1.0
            measures = RunMeasures(len(truth), coverage, ate_sim3_m=noise_m * 3**0.5, landmarks={"static": 3})
            place = str(folder.relative_to(tmp_path))
            found.append(BenchRun("simulator", variant, f"seed-{seed}", place, measures=measures))
    return found


def _dots(picture: Path) -> int:
    """How many dark round spots there are."""
    grey = cv2.imread(str(picture), cv2.IMREAD_GRAYSCALE)
    assert grey is not None
    blobs = cv2.connectedComponentsWithStats((grey < 40).astype(np.uint8))[2]
    return sum(28 <= area <= 60 and width == height <= 10 for _, _, width, height, area in blobs[1:])


def test_paths_of_lost_runs_are_not_among_those_compared(runs: list[BenchRun], tmp_path: Path) -> None:
    paths = read_paths(runs, tmp_path)
    assert set(paths) == {run.folder for run in runs} - {"simulator/base/seed-13"}
    assert paths["simulator/moving/seed-7"].error.absolute_m.rmse == pytest.approx(0.1 * 3**0.5, rel=0.2)


def test_pictures_are_the_same_bytes_every_time_and_differ_with_the_errors(
    runs: list[BenchRun], tmp_path: Path
) -> None:
    paths = read_paths(runs, tmp_path)
    pictures = [tmp_path / name for name in ("a.png", "b.png", "c.png", "d.png", "e.png", "f.png")]
    plot_errors(runs, paths, pictures[0], "label")
    plot_errors(runs, paths, pictures[1], "label")
    plot_errors(runs[:-1], paths, pictures[2], "label")
    plot_trials(runs, pictures[3])
    plot_trials([*runs[:-1], replace(runs[-1], failure="gone")], pictures[4])
    plot_axes(runs, paths, "simulator", pictures[5])
    data = [picture.read_bytes() for picture in pictures]
    assert data[0] == data[1]
    assert len(set(data)) == 5


def test_each_run_that_counts_has_a_dot(runs: list[BenchRun], tmp_path: Path) -> None:
    plot_errors(runs, read_paths(runs, tmp_path), tmp_path / "errors.png")
    assert _dots(tmp_path / "errors.png") == 3


def test_paths_by_axis_are_of_one_seed_for_seeds_drive_different_ways(runs: list[BenchRun], tmp_path: Path) -> None:
    # Of the other seed one variant was lost.
    first_seed = [run for run in runs if run.trial == "seed-7"]
    plot_axes(runs, read_paths(runs, tmp_path), "simulator", tmp_path / "all.png")
    plot_axes(first_seed, read_paths(first_seed, tmp_path), "simulator", tmp_path / "one.png")
    assert (tmp_path / "all.png").read_bytes() == (tmp_path / "one.png").read_bytes()


def test_runs_without_truth_draw_empty_panels(tmp_path: Path) -> None:
    runs = [BenchRun("03", "base", "repeat-1", "03/base/repeat-1", failure="gone")]
    plot_errors(runs, {}, tmp_path / "errors.png")
    plot_trials(runs, tmp_path / "trials.png")
    plot_axes(runs, {}, "03", tmp_path / "axes.png")
    assert (tmp_path / "axes.png").stat().st_size > 0


def test_the_file_comes_back_as_it_went(runs: list[BenchRun], tmp_path: Path) -> None:
    bench = Bench("kinemap bench", "label", "machine", 6, (*runs, replace(runs[0], failure="gone", measures=None)))
    write_bench(bench, tmp_path)
    assert read_bench(tmp_path) == bench
    assert '"status": "lost"' in (tmp_path / "bench.json").read_text()


@pytest.mark.parametrize(
    ("text", "part"),
    [("{", "not a benchmark's file"), ('{"version": 9}', "version 9, expected 1"), ('{"version": 1}', "'runs'")],
)
def test_another_file_is_none(tmp_path: Path, text: str, part: str) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_bench(tmp_path)
    (tmp_path / "bench.json").write_text(text)
    with pytest.raises(InputError, match=part):
        read_bench(tmp_path)
