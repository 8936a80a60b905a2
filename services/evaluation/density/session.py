# SPDX-License-Identifier: Apache-2.0
"""The density of every frame of a recorded session beside the true one."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas import topics
from schemas.codec import decode
from schemas.codec.rigid import matrix_from_pose
from schemas.records import TrueInstances
from schemas.topics import BY_KEY
from services.evaluation.density.error import DensityFrame
from services.evaluation.density.truth import TrueDensity, TrueDensityRules
from services.evaluation.run.session_log import SessionLog
from services.evaluation.trajectory.alignment import Alignment
from services.evaluation.trajectory.error import trajectory_error
from services.runtime.errors import InputError
from services.runtime.session_file import SessionFile

_TOPICS = (topics.TRUE_POSE, topics.TRUE_INSTANCES, topics.TRACKED_FRAME, topics.DENSITY)


@dataclass(frozen=True)
class SessionDensities:
    """`frames` in the order of time; `radius` in metres, or in map units that are `metres_per_unit` long."""

    frames: tuple[DensityFrame, ...]
    radius: float
    window_s: float
    metres_per_unit: float
    rules: TrueDensityRules


def read_densities(path: Path, rules: TrueDensityRules | None = None, recover: bool = False) -> SessionDensities:
    """Count what truly moves around the robot's true place at every frame that has a density.

    The truth is counted within the radius and window of the frame's own answer. Where the map's scale is arbitrary, the
    radius is brought to metres by the Sim(3) between the live and the true trajectory.

    Raises InputError where the session is missing, cut off (unless `recover`), or holds no density, true poses or true
    objects, or where its scale cannot be found.
    """
    log, true_density = SessionLog(), TrueDensity(rules)
    with SessionFile(path, recover=recover) as session:
        camera_from_base = _camera_from_base(session)
        counts: Counter[str] = Counter()
        for message in session.messages({topic.key for topic in _TOPICS}):
            counts[message.key] += 1
            record = decode(BY_KEY[message.key], message.payload)
            if isinstance(record, TrueInstances):
                true_density.add(record)
            else:
                log.add(message.sequence, record)
    for topic in (topics.DENSITY, topics.TRUE_POSE, topics.TRUE_INSTANCES):
        if not counts[topic.key]:
            raise InputError(f"{path}: no {topic} in it, expected the session of a run that has a ground truth")
    metres_per_unit = _metres_per_unit(path, log)
    frames = []
    for sequence in sorted(log.densities.keys() & log.true_poses.keys()):
        density = log.densities[sequence]
        position = (log.true_poses[sequence].world_from_camera @ camera_from_base)[:3, 3]
        radius_m = density.radius * metres_per_unit
        frames.append(
            DensityFrame(
                timestamp_ns=density.timestamp_ns,
                level=density.level,
                estimated_objects=density.moving_objects,
                estimated_points=density.moving_points,
                true_objects=true_density.at(density.timestamp_ns, position, radius_m, density.window_s),
            )
        )
    first = log.densities[min(log.densities)]
    return SessionDensities(tuple(frames), first.radius, first.window_s, metres_per_unit, true_density.rules)


def _camera_from_base(session: SessionFile) -> npt.NDArray[np.float64]:
    pose = session.config.get("mapstore", {}).get("base_from_camera")
    base_from_camera = np.eye(4) if pose is None else matrix_from_pose(np.array(pose, dtype=np.float64))
    camera_from_base: npt.NDArray[np.float64] = np.linalg.inv(base_from_camera).astype(np.float64)
    return camera_from_base


def _metres_per_unit(path: Path, log: SessionLog) -> float:
    # A frame without a place has a density without a scale.
    placed = [density for density in log.densities.values() if np.isfinite(density.position).all()]
    if all(density.metric_scale for density in placed):
        return 1.0
    live, truth = log.live_trajectory(), log.truth()
    if live is None or truth is None:
        return 1.0  # nothing was ever tracked: every density is unknown, and no radius is asked for
    try:
        return trajectory_error(live, truth, Alignment.SIM3).truth_from_estimate.scale
    except InputError as error:
        raise InputError(f"{path}: the map's scale is arbitrary, and its metres cannot be told: {error}") from None
