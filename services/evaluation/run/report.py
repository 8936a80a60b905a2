# SPDX-License-Identifier: Apache-2.0
"""The report of one run: what `report.json` holds, in plain dictionaries and numbers."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from schemas.records import DensityLevel, TrackingState
from services.evaluation.run.outcome import Report, RunOutcome, ServiceUsage
from services.evaluation.run.session_log import SessionLog
from services.evaluation.trajectory.alignment import Alignment
from services.evaluation.trajectory.description import describe_error
from services.evaluation.trajectory.error import trajectory_error
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError, KinemapError

REPORT_VERSION = 1


def build_report(
    log: SessionLog,
    trajectory: Trajectory | None,
    services: Mapping[str, ServiceUsage],
    outcome: RunOutcome,
) -> Report:
    """Put the report together. `trajectory` is the exported one (poses after the map's last correction)."""
    manifest = log.manifests[min(log.manifests)] if log.manifests else None
    first_tracked = log.tracked[min(log.tracked)] if log.tracked else None
    frames = _frames(log, trajectory)
    failure = outcome.failure or (_unaccounted(frames) if outcome.every_frame else "")
    return {
        "version": REPORT_VERSION,
        "session": outcome.session,
        "input": manifest.source if manifest else "",
        "stage": first_tracked.handling if first_tracked else "",
        "complete": not failure,
        "failure": failure,
        "frames": frames,
        "scale": _scale(log),
        "trajectory_length": trajectory.length_m if trajectory else 0.0,
        "ate": _errors(log, trajectory),
        "stage_ms": stage_times(log, services),
        "landmarks": log.map_points.counts_by_label(),
        "keyframes": log.map_points.keyframes,
        "maps": log.map_points.maps,
        "density_frames": _density_frames(log),
        "moving_flag": _moving_flag(log),
        "services": {
            name: {"peak_memory_bytes": usage.peak_memory_bytes, "starts": usage.starts}
            for name, usage in sorted(services.items())
        },
        "wall_s": outcome.wall_s,
        "driven_s": outcome.driven_s,
        "frames_per_s": (len(log.tracked) - 1) / outcome.driven_s if outcome.driven_s and log.tracked else None,
    }


def write_report(report: Report, path: Path) -> None:
    """Write JSON with sorted keys; what is not finite becomes null, since JSON has no name for it."""
    path.write_text(json.dumps(_finite(report), indent=2, sort_keys=True, allow_nan=False) + "\n", encoding="utf-8")


def read_report(path: Path) -> Report:
    """Read a report back. Raises InputError for one that is missing, no JSON, of another version, or not whole."""
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such report, expected the report.json of a run") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a report ({error})") from None
    version = report.get("version") if isinstance(report, dict) else None
    if version != REPORT_VERSION:
        raise InputError(f"{path}: report of version {version}, expected {REPORT_VERSION}")
    if not _is_whole(report):
        raise InputError(f"{path}: not a whole report, expected one as `kinemap run` writes it")
    return dict(report)


def stage_times(log: SessionLog, services: Mapping[str, ServiceUsage]) -> dict[str, dict[str, float]]:
    """Milliseconds a frame, p50 and p95: slam's own stages from its frames, each service's from its last heartbeat."""
    samples: dict[str, list[float]] = {}
    for frame in log.tracked.values():
        for stage, milliseconds in frame.stage_ms.items():
            samples.setdefault(f"slam/{stage}", []).append(milliseconds)
    times = {
        stage: {"p50": float(np.percentile(values, 50)), "p95": float(np.percentile(values, 95))}
        for stage, values in samples.items()
    }
    for name, usage in services.items():
        for metric, median in usage.metrics.items():
            stage = metric.removesuffix("_ms_p50")
            if stage != metric and f"{stage}_ms_p95" in usage.metrics:
                times[name if stage == "process" else f"{name}/{stage}"] = {
                    "p50": median,
                    "p95": usage.metrics[f"{stage}_ms_p95"],
                }
    return dict(sorted(times.items()))


def _is_whole(report: Report) -> bool:
    """Whether all is there, and of its kind, that tables of runs are made of."""
    match report:
        case {
            "failure": str(),
            "frames": {"in": int(), "expected": int(), "tracked": int()},
            "ate": None | dict() as ate,
            "landmarks": dict() as landmarks,
            "density_frames": dict() as density_frames,
            "moving_flag": None | {"precision": _, "recall": _, "f1": _},
            "services": dict() as services,
            "frames_per_s": None | int() | float(),
        }:
            counts = [*landmarks.values(), *density_frames.values()]
            times_s = report.get("wall_s"), report.get("driven_s")
            stage_ms = report.get("stage_ms", {})
            return (
                all(isinstance(count, int) for count in counts)
                and all(time_s is None or isinstance(time_s, int | float) for time_s in times_s)
                and isinstance(stage_ms, dict)
                and all(isinstance(error, dict) for error in (ate or {}).values())
                and all(isinstance(times, dict) and {"p50", "p95"} <= times.keys() for times in stage_ms.values())
                and all(isinstance(usage, dict) and "peak_memory_bytes" in usage for usage in services.values())
            )
    return False


def _frames(log: SessionLog, trajectory: Trajectory | None) -> Report:
    states = [log.tracked[sequence].state for sequence in sorted(log.tracked)]
    tracked = states.count(TrackingState.TRACKING)
    initialized = states.index(TrackingState.TRACKING) if tracked else None
    manifest_count = max((manifest.frame_count for manifest in log.manifests.values()), default=-1)
    return {
        "in": len(log.manifests),
        "expected": manifest_count if manifest_count >= 0 else len(log.manifests),
        "answered": len(states),
        "tracked": tracked,
        "lost": states.count(TrackingState.LOST),
        "initializing": states.count(TrackingState.INITIALIZING),
        "initialized_at": initialized,
        "tracked_after_initialization": None if initialized is None else tracked / (len(states) - initialized),
        "in_trajectory": len(trajectory) if trajectory else 0,
    }


def _unaccounted(frames: Report) -> str:
    if frames["in"] == frames["answered"] >= max(frames["expected"], 1):
        return ""
    return (
        f"{frames['expected']} frames in the input, {frames['in']} recorded, {frames['answered']} answered by slam:"
        " expected the same number everywhere, and one at least"
    )


def _scale(log: SessionLog) -> str:
    if not log.tracked:
        return "unknown"
    return "metric" if log.tracked[max(log.tracked)].metric_scale else "arbitrary"


def _errors(log: SessionLog, trajectory: Trajectory | None) -> Report | None:
    truth = log.truth()
    if truth is None:
        return None
    candidates = [("final", trajectory, Alignment.SIM3), ("live", log.live_trajectory(), Alignment.SIM3)]
    if _scale(log) == "metric":
        candidates.append(("final_metric", trajectory, Alignment.SE3))
    errors: Report = {}
    for name, estimate, alignment in candidates:
        try:
            if estimate is None:
                raise InputError("no tracked pose")
            errors[name] = describe_error(trajectory_error(estimate, truth, alignment, frames=len(log.manifests)))
        except KinemapError as error:
            errors[name] = {"alignment": alignment.value, "none_because": str(error)}
    return errors


def _density_frames(log: SessionLog) -> dict[str, int]:
    levels = [density.level for density in log.densities.values()]
    return {level.name.lower(): levels.count(level) for level in DensityLevel}


def _moving_flag(log: SessionLog) -> Report | None:
    score = log.moving_flag.score
    if score.frames == 0:
        return None
    return {
        **asdict(score),
        "precision": score.precision,
        "recall": score.recall,
        "f1": score.f1,
        "rules": asdict(log.moving_flag.rules),
    }


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
