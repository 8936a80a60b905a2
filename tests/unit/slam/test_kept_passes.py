# SPDX-License-Identifier: Apache-2.0
"""A benchmark that is started again finds what it has run already."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from tests.benchmark.slam.engine_pass import EnginePass, PassReport
from tests.benchmark.slam.kept_passes import KeptPasses, run_missing
from tests.benchmark.slam.sequence_part import SequencePart

PASS = EnginePass((SequencePart(Path("nowhere")),), "moving", {"seed": 1}, "a pass")
REPORT = PassReport(
    name="a pass",
    frames=2,
    initialized_at=1,
    coverage=0.5,
    tracked_share=1.0,
    ate_m=0.25,
    ate_se3_m=float("nan"),
    online_ate_m=0.5,
    scale=2.0,
    maps=1,
    keyframes=3,
    culled=0,
    landmarks={0: 5, 2: 1},
    wall_ms=np.array([1.5, 2.5]),
    cpu_ms=np.array([1.0, 2.0]),
    read_ms=np.array([0.5, 0.5]),
    rss_mb=np.array([10.0, 11.0]),
    sizes=np.array([[1, 2], [3, 4]]),
    stage_ms={"extract": 1.0},
    states=np.array([0, 1]),
    reasons=["waiting", ""],
    digest="00",
    peak_rss_mb=12.0,
    part_starts=[0],
    indices=[1],
    centers=np.array([[1.0, 2.0, 3.0]]),
    true_centers=np.zeros((2, 3)),
)


def test_a_report_comes_back_as_it_was(tmp_path: Path) -> None:
    KeptPasses(tmp_path).keep(PASS, REPORT)
    again = KeptPasses(tmp_path).find(PASS)
    assert again is not None
    for field in fields(PassReport):
        np.testing.assert_equal(getattr(again, field.name), getattr(REPORT, field.name), field.name)


def test_another_pass_is_not_found(tmp_path: Path) -> None:
    kept = KeptPasses(tmp_path)
    kept.keep(PASS, REPORT)
    assert kept.find(replace(PASS, stage="base")) is None
    assert kept.find(replace(PASS, options={"seed": 2})) is None


def test_nothing_that_was_kept_is_run_again(tmp_path: Path) -> None:
    kept = KeptPasses(tmp_path)
    kept.keep(PASS, REPORT)
    assert [report.digest for report in run_missing([PASS, PASS], 1, kept)] == ["00", "00"]
