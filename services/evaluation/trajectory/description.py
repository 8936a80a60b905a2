# SPDX-License-Identifier: Apache-2.0
"""A trajectory's error in plain dictionaries and numbers, as report.json and `kinemap evaluate --json` hold it."""

from dataclasses import asdict

from services.evaluation.run.outcome import Report
from services.evaluation.trajectory.error import TrajectoryError
from services.evaluation.trajectory.kitti_segments import SegmentError
from services.evaluation.trajectory.relative_error import RelativeError


def describe_error(error: TrajectoryError) -> Report:
    """Every error with its coverage beside it; None where there was nothing to measure."""
    return {
        "alignment": error.alignment.value,
        "frames": error.frames,
        "poses": len(error.errors_m),
        "coverage": error.coverage,
        "scale": error.truth_from_estimate.scale,
        "ate_m": asdict(error.absolute_m),
        "rpe_frames": int(error.by_frames.delta),
        "rpe_m": asdict(error.by_frames.translation_m) if error.by_frames.translation_m else None,
        "rpe_deg": asdict(error.by_frames.rotation_deg) if error.by_frames.rotation_deg else None,
        "rpe_coverage": error.by_frames.coverage,
        "rpe_path": _relative(error.by_path),
        "kitti": {
            **_segments(error.segments.overall),
            "by_length": [_segments(segment) for segment in error.segments.by_length if segment.possible],
        },
    }


def _relative(error: RelativeError) -> Report:
    return {
        "delta_m": error.delta,
        "pairs": error.pairs,
        "coverage": error.coverage,
        "translation_m": asdict(error.translation_m) if error.translation_m else None,
        "rotation_deg": asdict(error.rotation_deg) if error.rotation_deg else None,
    }


def _segments(error: SegmentError) -> Report:
    described = {**asdict(error), "coverage": error.coverage}
    if error.length_m is None:
        del described["length_m"]
    return described
