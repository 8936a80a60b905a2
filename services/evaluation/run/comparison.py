# SPDX-License-Identifier: Apache-2.0
"""Several reports side by side: the stages of one input, or one stage over several inputs."""

from collections.abc import Sequence
from typing import NamedTuple

from services.evaluation.run.outcome import Report

NOTHING = "-"


class ComparisonRow(NamedTuple):
    """One measure of every run, in the runs' order."""

    what: str
    values: tuple[str, ...]


def compare(reports: Sequence[Report]) -> list[ComparisonRow]:
    """What tells runs apart; a measure that no run has is left out, one that a run lacks is a dash there."""
    columns = [_measures(report) for report in reports]
    names = list(dict.fromkeys(name for column in columns for name in column))
    return [ComparisonRow(name, tuple(column.get(name, NOTHING) for column in columns)) for name in names]


def _measures(report: Report) -> dict[str, str]:
    frames = report["frames"]
    measures = {
        "input": str(report.get("input", NOTHING)),
        "stage": str(report.get("stage", NOTHING)),
        "whole input": "no" if report["failure"] else "yes",
        "frames tracked": f"{frames['tracked']} of {frames['in']}",
    }
    if frames.get("initialized_at") is not None and frames.get("tracked_after_initialization") is not None:
        measures["initialized at frame"] = str(frames["initialized_at"])
        measures["tracked since then"] = f"{frames['tracked_after_initialization']:.1%}"
    for name, error in (report["ate"] or {}).items():
        if "ate_m" in error:
            measures[f"ATE {name} RMSE [m]"] = f"{error['ate_m']['rmse']:.3f}"
            measures[f"ATE {name} coverage"] = f"{error['coverage']:.1%}"
    measures["keyframes"] = str(report.get("keyframes", NOTHING))
    measures |= {f"landmarks {label}": str(count) for label, count in report["landmarks"].items() if count}
    measures |= {f"density {level} [frames]": str(count) for level, count in report["density_frames"].items()}
    flag = report["moving_flag"]
    if flag is not None:
        for name in ("precision", "recall", "f1"):
            measures[f"moving flag {name}"] = NOTHING if flag[name] is None else f"{flag[name]:.3f}"
    for stage, times in report.get("stage_ms", {}).items():
        measures[f"{stage} p50/p95 [ms]"] = f"{times['p50']:.1f}/{times['p95']:.1f}"
    if report["frames_per_s"]:
        measures["frames/s"] = f"{report['frames_per_s']:.1f}"
    return measures
