# SPDX-License-Identifier: Apache-2.0
"""The runs of a benchmark, and what is compared of each."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from services.evaluation.run.outcome import Report

LEAST_COVERAGE = 0.95
"""A run that tracked a smaller share of its frames is lost: the error of what is left says little."""


class RunStatus(StrEnum):
    """How a run ended."""

    TRACKED = "tracked"
    LOST = "lost"
    """it went through whole, and tracked less than LEAST_COVERAGE of its frames"""
    FAILED = "failed"


@dataclass(frozen=True)
class RunMeasures:
    """What is compared of one run; None where the input has no truth for it, or the run did not tell.

    `coverage` is the share of the input's frames that were tracked, and no more than the errors speak of. Errors are
    RMSE after the map's last correction: `ate_sim3_m` and `ate_se3_m` absolute by alignment, `rpe_m` and `rpe_deg`
    relative from frame to frame. These and KITTI's segment errors are in the map's own metres, or scaled to the truth
    where it has none.
    `peak_memory_bytes` is the sum of every service's own peak.
    """

    frames: int
    coverage: float
    ate_sim3_m: float | None = None
    ate_se3_m: float | None = None
    rpe_m: float | None = None
    rpe_deg: float | None = None
    segment_percent: float | None = None
    segment_deg_per_100_m: float | None = None
    flag_precision: float | None = None
    flag_recall: float | None = None
    landmarks: dict[str, int] = field(default_factory=dict)
    density_frames: dict[str, int] = field(default_factory=dict)
    frames_per_s: float | None = None
    peak_memory_bytes: int | None = None


@dataclass(frozen=True)
class BenchRun:
    """One run: of what, in which variant (a stage, or any other configuration), which seed or repeat."""

    input: str
    variant: str
    trial: str
    folder: str
    """relative to the benchmark's folder"""
    fingerprint: str = ""
    failure: str = ""
    """one line; empty where the run went through whole"""
    wall_s: float = 0.0
    measures: RunMeasures | None = None

    @property
    def status(self) -> RunStatus:
        """How it ended."""
        if self.failure or self.measures is None:
            return RunStatus.FAILED
        return RunStatus.LOST if self.measures.coverage < LEAST_COVERAGE else RunStatus.TRACKED

    @property
    def verdict(self) -> str:
        """What is to be said of it in one line."""
        measures = self.measures
        if self.failure or measures is None:
            return f"failed: {self.failure or 'no report'}"
        error = "" if measures.ate_sim3_m is None else f", ATE {measures.ate_sim3_m:.3f} m over those"
        if self.status is RunStatus.LOST:
            return f"lost: {measures.coverage:.1%} of {measures.frames} frames tracked{error}"
        return f"{measures.coverage:.1%} of {measures.frames} frames tracked{error}"


def tracked(runs: Iterable[BenchRun], source: str, variant: str) -> list[BenchRun]:
    """The runs of one input and variant whose numbers count."""
    return [run for run in runs if (run.input, run.variant) == (source, variant) and run.status is RunStatus.TRACKED]


def measures_of(report: Report, *, alone: bool = True) -> RunMeasures:
    """What is compared of the run that `report` tells of.

    `alone`: no other run of the benchmark shared the machine with it; else its speed says nothing and is left out.
    """
    frames = report["frames"]
    count = max(frames["in"], frames["expected"], 1)
    errors = report["ate"] or {}
    absolute, metric = errors.get("final", {}), errors.get("final_metric", {})
    scaled = metric if "ate_m" in metric else absolute
    segments = scaled.get("kitti", {})
    rotation_deg_per_m = segments.get("rotation_deg_per_m")
    coverage = frames["tracked"] / count
    if "coverage" in absolute:
        coverage = min(coverage, absolute["coverage"])
    flag = report["moving_flag"] or {}
    return RunMeasures(
        frames=count,
        coverage=coverage,
        ate_sim3_m=_rmse(absolute, "ate_m"),
        ate_se3_m=_rmse(metric, "ate_m"),
        rpe_m=_rmse(scaled, "rpe_m"),
        rpe_deg=_rmse(scaled, "rpe_deg"),
        segment_percent=segments.get("translation_percent"),
        segment_deg_per_100_m=None if rotation_deg_per_m is None else 100.0 * rotation_deg_per_m,
        flag_precision=flag.get("precision"),
        flag_recall=flag.get("recall"),
        landmarks=dict(report["landmarks"]),
        density_frames=dict(report["density_frames"]),
        frames_per_s=report["frames_per_s"] if alone else None,
        peak_memory_bytes=sum(usage["peak_memory_bytes"] for usage in report["services"].values()) or None,
    )


def _rmse(error: dict[str, Any], name: str) -> float | None:
    statistics = error.get(name)
    return None if statistics is None else statistics["rmse"]
