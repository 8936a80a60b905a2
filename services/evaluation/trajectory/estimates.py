# SPDX-License-Identifier: Apache-2.0
"""Estimates that stand side by side: their names, their files, the truth they share."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from services.evaluation.run.folder import TRAJECTORY_NAME, TRUTH_NAME
from services.evaluation.trajectory.error import TrajectoryError
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


@dataclass(frozen=True)
class EvaluatedTrajectory:
    """One estimate and how far it is from the truth; `name` tells it from the others in tables and pictures."""

    name: str
    trajectory: Trajectory
    error: TrajectoryError


def estimate_files(given: Sequence[Path]) -> dict[str, Path]:
    """The trajectory file of each path by a name of its own: a run's folder gives its trajectory.tum.

    The name is the folder's or the file's, or the whole path where two would be called the same. Raises InputError for
    a folder without a trajectory, and for a path that is given twice.
    """
    short = Counter(_short_name(path) for path in given)
    files: dict[str, Path] = {}
    for path in given:
        name = _short_name(path) if short[_short_name(path)] == 1 else str(path)
        if name in files:
            raise InputError(f"{path}: given twice, expected different estimates")
        files[name] = path / TRAJECTORY_NAME if path.is_dir() else path
        if path.is_dir() and not files[name].is_file():
            raise InputError(f"{path}: no {TRAJECTORY_NAME} here, expected the folder of a run or a trajectory file")
    return files


def recorded_truth(given: Sequence[Path]) -> Path:
    """The ground_truth.tum that the runs' folders among `given` share.

    Raises InputError where no folder has one, or two folders have different ones.
    """
    found = [path / TRUTH_NAME for path in given if path.is_dir() and (path / TRUTH_NAME).is_file()]
    if not found:
        raise InputError(
            f"{given[0]}: expected --truth with the true trajectory, or the folder of a run with {TRUTH_NAME} instead"
        )
    first = found[0].read_bytes()
    for other in found[1:]:
        if other.read_bytes() != first:
            raise InputError(f"{other}: not the same as {found[0]}, expected runs of one input")
    return found[0]


def _short_name(path: Path) -> str:
    return path.resolve().name if path.is_dir() else path.stem
