# SPDX-License-Identifier: Apache-2.0
"""Errors of trajectories side by side, as text: every error with the share of the input that it speaks of."""

from collections.abc import Sequence
from dataclasses import asdict

from services.evaluation.run.comparison import NOTHING, ComparisonRow
from services.evaluation.trajectory.error import TrajectoryError
from services.evaluation.trajectory.estimates import EvaluatedTrajectory
from services.evaluation.trajectory.kitti_segments import SegmentError
from services.evaluation.trajectory.relative_error import RelativeError


def trajectory_rows(evaluated: Sequence[EvaluatedTrajectory]) -> list[ComparisonRow]:
    """What the table shows, one value an estimate; KITTI's lengths that the truth does not have are left out."""
    columns = [_measures(item.error) for item in evaluated]
    names = list(dict.fromkeys(name for column in columns for name in column))
    return [ComparisonRow(name, tuple(column.get(name, NOTHING) for column in columns)) for name in names]


def _measures(error: TrajectoryError) -> dict[str, str]:
    measures = {
        "poses": f"{len(error.errors_m)} of {error.frames} frames ({error.coverage:.1%})",
        "alignment": f"{error.alignment.value}, scale {error.truth_from_estimate.scale:.4g}",
    }
    for name, value in asdict(error.absolute_m).items():
        measures[f"ATE {_statistic(name)} [m]"] = f"{value:.3f} ({error.coverage:.1%})"
    measures |= _relative(error.by_frames) | _relative(error.by_path)
    for segment in (error.segments.overall, *error.segments.by_length):
        if segment.possible or segment.length_m is None:
            measures |= _segment(segment)
    return measures


def _relative(error: RelativeError) -> dict[str, str]:
    unit = "m" if error.unit == "m" else "frame" if error.delta == 1 else "frames"
    measures = {}
    for kind, statistics in (("m", error.translation_m), ("deg", error.rotation_deg)):
        for name in ("rmse", "mean", "median"):
            value = NOTHING if statistics is None else f"{asdict(statistics)[name]:.3f}"
            measures[f"RPE {error.delta:g} {unit} {_statistic(name)} [{kind}]"] = f"{value} ({error.coverage:.1%})"
    return measures


def _segment(error: SegmentError) -> dict[str, str]:
    length = "" if error.length_m is None else f" {error.length_m} m"
    values = {"[%]": error.translation_percent, "[deg/m]": error.rotation_deg_per_m}
    digits = {"[%]": 3, "[deg/m]": 5}
    return {
        f"KITTI segments{length} {unit}": NOTHING
        if value is None
        else f"{value:.{digits[unit]}f} ({error.segments} of {error.possible}, {error.coverage:.1%})"
        for unit, value in values.items()
    }


def _statistic(name: str) -> str:
    return "RMSE" if name == "rmse" else name
