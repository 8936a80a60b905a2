# SPDX-License-Identifier: Apache-2.0
"""A benchmark's tables: what counts, what does not, and who is better."""

import pytest

from services.evaluation.bench.ratios import ratio_table
from services.evaluation.bench.runs import BenchRun, RunMeasures, RunStatus, measures_of
from services.evaluation.bench.table import BenchTable, summary_table
from services.evaluation.run.outcome import Report

RMSE = {"rmse": 1.0, "mean": 9.0, "median": 9.0, "max": 9.0}


def _run(
    variant: str,
    seed: int,
    ate_m: float | None,
    *,
    coverage: float = 1.0,
    source: str = "simulator",
    failure: str = "",
    frames_per_s: float | None = 10.0,
) -> BenchRun:
    measures = RunMeasures(100, coverage, ate_sim3_m=ate_m, frames_per_s=frames_per_s, landmarks={"static": 7})
    folder = f"{source}/{variant}/seed-{seed}"
    return BenchRun(source, variant, f"seed-{seed}", folder, failure=failure, measures=None if failure else measures)


def _row(table: BenchTable | None, *beginning: str) -> dict[str, str]:
    assert table is not None
    rows = [row for row in table.rows if row[: len(beginning)] == beginning]
    assert len(rows) == 1, table
    return dict(zip(table.header, rows[0], strict=True))


def _report(**changes: object) -> Report:
    report: Report = {
        "frames": {"in": 100, "expected": 100, "tracked": 98},
        "ate": {
            "final": {"coverage": 0.97, "ate_m": RMSE | {"rmse": 2.0}, "rpe_m": RMSE, "rpe_deg": RMSE},
            "final_metric": {
                "coverage": 0.97,
                "ate_m": RMSE | {"rmse": 3.0},
                "rpe_m": RMSE | {"rmse": 0.5},
                "rpe_deg": RMSE | {"rmse": 0.25},
                "kitti": {"translation_percent": 4.0, "rotation_deg_per_m": 0.02},
            },
        },
        "moving_flag": {"precision": 0.9, "recall": None},
        "landmarks": {"static": 5},
        "density_frames": {"low": 100},
        "frames_per_s": 8.0,
        "services": {"slam": {"peak_memory_bytes": 3}, "camera": {"peak_memory_bytes": 4}},
    }
    return report | changes


def test_a_row_holds_median_and_range_of_the_runs_of_one_input_and_variant() -> None:
    runs = [_run("base", 7, 3.0), _run("base", 13, 1.0), _run("base", 14, 2.0), _run("moving", 7, 0.5)]
    table = summary_table(runs)
    assert _row(table, "simulator", "base")["ATE Sim(3) [m]"] == "2.000 [1.000..3.000]"
    assert _row(table, "simulator", "base")["runs"] == "3"
    assert _row(table, "simulator", "moving")["ATE Sim(3) [m]"] == "0.500"


def test_a_lost_run_is_shown_and_never_counted() -> None:
    runs = [_run("base", 7, 1.0), _run("base", 13, 90.0, coverage=0.949), _run("base", 14, 3.0, coverage=0.95)]
    table = summary_table(runs)
    row = _row(table, "simulator", "base", "3, 1 lost")
    assert row["ATE Sim(3) [m]"] == "2.000 [1.000..3.000]"
    assert row["coverage, median (least)"] == "95.0% (94.9%)"
    told = _row(table, "simulator", "base", "seed-13")["coverage, median (least)"]
    assert told == "lost: 94.9% of 100 frames tracked, ATE 90.000 m over those"


def test_a_failed_run_is_one_row_with_its_one_line() -> None:
    runs = [_run("base", 7, 1.0), _run("base", 13, None, failure="slam: gone")]
    table = summary_table(runs)
    assert _row(table, "simulator", "base", "2, 1 failed")["coverage, median (least)"] == "100.0% (100.0%)"
    assert _row(table, "simulator", "base", "seed-13")["coverage, median (least)"] == "failed: slam: gone"
    assert len(summary_table(runs, with_setbacks=False).rows) == 1


def test_where_nothing_was_tracked_there_are_no_numbers() -> None:
    table = summary_table([_run("base", 7, None, failure="slam: gone"), _run("moving", 7, 1.0)])
    row = _row(table, "simulator", "base", "1, 1 failed")
    assert {row["ATE Sim(3) [m]"], row["coverage, median (least)"], row["frames/s"]} == {"-"}


def test_columns_that_nobody_fills_are_left_out() -> None:
    header = summary_table([_run("base", 7, None)]).header
    assert header[:4] == ("input", "variant", "runs", "coverage, median (least)")
    assert "ATE Sim(3) [m]" not in header
    assert "landmarks static / standing / moving" in header


def test_ratios_are_of_equal_seeds_only() -> None:
    runs = [
        *(_run("base", seed, ate_m) for seed, ate_m in ((7, 1.0), (13, 2.0), (14, 4.0))),
        *(_run("moving", seed, ate_m) for seed, ate_m in ((13, 1.0), (7, 2.0), (14, 3.0), (15, 0.001))),
    ]
    row = _row(ratio_table(runs), "simulator", "moving / base")
    assert row["pairs"] == "3"
    assert row["ATE Sim(3)"] == "0.75 (better in 2 of 3)"


def test_a_lost_run_takes_its_pair_with_it() -> None:
    runs = [_run("base", 7, 1.0), _run("moving", 7, 0.1, coverage=0.5), _run("base", 13, 1.0), _run("moving", 13, 2.0)]
    assert _row(ratio_table(runs), "simulator", "moving / base")["ATE Sim(3)"] == "2.00 (better in 0 of 1)"
    assert ratio_table(runs[:2]) is None


def test_more_frames_a_second_are_better() -> None:
    runs = [_run("base", 7, 1.0, frames_per_s=5.0), _run("moving", 7, 1.0, frames_per_s=10.0)]
    assert _row(ratio_table(runs), "simulator")["frames/s"] == "2.00 (better in 1 of 1)"


def test_all_inputs_together_and_the_last_variant_against_each_other_one() -> None:
    runs = [
        _run(variant, 7, ate_m, source=source)
        for source, factor in (("simulator", 1.0), ("03", 2.0))
        for variant, ate_m in (("base", 4.0), ("dynamic", 2.0), ("moving", 1.0 * factor))
    ]
    table = ratio_table(runs)
    assert table is not None
    assert [row[:3] for row in table.rows] == [
        *((source, "moving / base", pairs) for source, pairs in (("simulator", "1"), ("03", "1"), ("all", "2"))),
        *((source, "moving / dynamic", pairs) for source, pairs in (("simulator", "1"), ("03", "1"), ("all", "2"))),
    ]
    assert _row(table, "all", "moving / base")["ATE Sim(3)"] == "0.38 (better in 2 of 2)"


def test_metres_come_from_the_metric_alignment_where_there_is_one() -> None:
    measures = measures_of(_report())
    assert (measures.ate_sim3_m, measures.ate_se3_m) == (2.0, 3.0)
    assert (measures.rpe_m, measures.rpe_deg) == (0.5, 0.25)
    assert (measures.segment_percent, measures.segment_deg_per_100_m) == (4.0, 2.0)
    assert measures.coverage == 0.97
    assert measures.peak_memory_bytes == 7
    assert measures.frames_per_s == 8.0
    assert measures_of(_report(), alone=False).frames_per_s is None


@pytest.mark.parametrize("ate", [None, {"final": {"alignment": "sim3", "none_because": "2 poses"}}])
def test_a_run_without_truth_or_pose_has_coverage_and_no_errors(ate: Report | None) -> None:
    measures = measures_of(_report(ate=ate, moving_flag=None))
    assert measures.coverage == 0.98
    assert (measures.ate_sim3_m, measures.rpe_m, measures.flag_precision) == (None, None, None)


def test_a_run_that_ended_early_covers_what_the_input_has() -> None:
    frames = {"in": 50, "expected": 100, "tracked": 50}
    measures = measures_of(_report(frames=frames, ate=None))
    run = BenchRun("a", "b", "c", "d", measures=measures)
    assert (measures.coverage, run.status) == (0.5, RunStatus.LOST)
