# SPDX-License-Identifier: Apache-2.0
"""The thesis' tables of trajectory errors, from runs with known ones."""

from pathlib import Path

import pytest

from services.evaluation.bench.runs import BenchRun, RunMeasures
from services.evaluation.thesis.odometry import comparison_table, describe_odometry, stage_errors, trials_table
from services.evaluation.thesis.odometry_plots import plot_bars, plot_top_view


def _run(
    sequence: str, stage: str, trial: int, ate_m: float | None, *, coverage: float = 1.0, failure: str = ""
) -> BenchRun:
    measures = None if failure else RunMeasures(frames=100, coverage=coverage, ate_sim3_m=ate_m)
    folder = f"{sequence}/{stage}/repeat-{trial}"
    return BenchRun(sequence, stage, f"repeat-{trial}", folder, failure=failure, measures=measures)


RUNS = (
    *(_run("07", "dynamic", trial, ate_m) for trial, ate_m in enumerate((2.03, 1.82, 4.11, 1.93, 1.72), start=1)),
    _run("07", "moving", 1, 2.0),
    _run("07", "moving", 2, 9.0, coverage=0.5),
    _run("07", "moving", 3, None, failure="killed"),
    _run("03", "dynamic", 1, 0.5),
)


def test_the_average_of_the_thesis_trials_is_its_own() -> None:
    row = stage_errors(RUNS)[0]
    assert (row.sequence, row.stage) == ("07", "dynamic")
    assert row.average_m == pytest.approx(2.322)
    assert row.middle_run is RUNS[3]


def test_trials_stand_in_the_layout_of_table_5_2() -> None:
    table = trials_table(stage_errors(RUNS), "dynamic")
    assert table.header == ("sequence", "T1", "T2", "T3", "T4", "T5", "average", "tracked, least")
    assert table.rows[0] == ("07", "2.030", "1.820", "4.110", "1.930", "1.720", "2.322", "100.0%")
    assert table.rows[1] == ("03", "0.500", "-", "-", "-", "-", "0.500", "100.0%")


def test_a_trial_that_was_lost_or_failed_is_said_and_not_averaged() -> None:
    table = trials_table(stage_errors(RUNS), "moving")
    assert table.rows == (("07", "2.000", "lost (50%)", "failed", "2.000 (1 of 3)", "50.0%"),)


def test_published_numbers_stand_beside_whole_sequences_alone() -> None:
    rows = stage_errors(RUNS)
    whole = comparison_table(rows, whole_sequences=True)
    assert whole.header[-2:] == ("kinemap, dynamic", "kinemap, moving")
    assert whole.rows[0] == ("07", "2.260", "2.360", "2.320", "1.970", "2.322", "2.000")
    assert whole.rows[1] == ("03", "-", "-", "-", "-", "0.500", "-")
    assert comparison_table(rows, whole_sequences=False).rows[0][1:5] == ("-",) * 4


def test_json_says_what_every_trial_was() -> None:
    described = describe_odometry(stage_errors(RUNS), frames=100)
    assert described["frames"] == 100
    moving = described["rows"][1]
    assert moving["ate_m"] == [2.0, None, None]
    assert moving["coverage"] == [1.0, 0.5, None]
    assert moving["verdicts"][2] == "failed: killed"


def test_bars_are_the_same_bytes_again_and_tell_whole_sequences_from_parts(tmp_path: Path) -> None:
    rows = stage_errors(RUNS)
    for name, whole in (("a.png", True), ("b.png", True), ("part.png", False)):
        plot_bars(rows, tmp_path / name, whole_sequences=whole)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "part.png").read_bytes()


def test_without_a_path_there_is_no_top_view(tmp_path: Path) -> None:
    assert not plot_top_view(stage_errors(RUNS), {}, "07", tmp_path / "top.png")
    assert not list(tmp_path.iterdir())
