# SPDX-License-Identifier: Apache-2.0
"""What a report needs of a session, gathered message by message from the recording."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from schemas import topics
from schemas.codec.rigid import matrix_from_pose
from schemas.records import (
    Density,
    FrameManifest,
    MapUpdate,
    Objects,
    TrackedFrame,
    TrackingState,
    TrueInstances,
    TruePose,
)
from services.evaluation.map.points import MapPoints
from services.evaluation.run.moving_flag import MovingFlagEvaluator
from services.formats.trajectory import Trajectory

READ_TOPICS = (
    topics.MANIFEST,
    topics.TRUE_POSE,
    topics.TRUE_INSTANCES,
    topics.OBJECTS,
    topics.TRACKED_FRAME,
    topics.MAP_UPDATE,
    topics.DENSITY,
)
"""The topics of a recording that `SessionLog.add` takes."""

NO_MAP = -1

# Truth and objects of one frame lie fewer frames apart than this; a frame whose objects never came is let go.
_PENDING_FRAMES = 64


@dataclass
class SessionLog:
    """One session so far. Frames are keyed by their sequence number, so that a message recorded twice counts once."""

    manifests: dict[int, FrameManifest] = field(default_factory=dict)
    tracked: dict[int, TrackedFrame] = field(default_factory=dict)
    densities: dict[int, Density] = field(default_factory=dict)
    true_poses: dict[int, TruePose] = field(default_factory=dict)
    map_points: MapPoints = field(default_factory=MapPoints)
    moving_flag: MovingFlagEvaluator = field(default_factory=MovingFlagEvaluator)
    _mapped: set[int] = field(default_factory=set)
    _scored: set[int] = field(default_factory=set)
    _pending_truth: dict[int, TrueInstances] = field(default_factory=dict)
    _pending_objects: dict[int, Objects] = field(default_factory=dict)

    def add(self, sequence: int, record: object) -> None:
        """Take one record of the frame `sequence`; those of other topics than READ_TOPICS are passed over."""
        match record:
            case FrameManifest():
                self.manifests.setdefault(sequence, record)
            case TrackedFrame():
                self.tracked.setdefault(sequence, record)
            case Density():
                self.densities.setdefault(sequence, record)
            case TruePose():
                self.true_poses.setdefault(sequence, record)
            case MapUpdate() if sequence not in self._mapped:
                self._mapped.add(sequence)
                self.map_points.add(record)
            case TrueInstances() if sequence not in self._scored:
                self._pending_truth[sequence] = record
                self._score(sequence)
            case Objects() if sequence not in self._scored:
                self._pending_objects[sequence] = record
                self._score(sequence)
            case _:
                pass

    def truth(self) -> Trajectory | None:
        """The true poses; None where the source has none."""
        return _trajectory({pose.timestamp_ns: pose.world_from_camera for pose in self.true_poses.values()}, "truth")

    def main_map_id(self) -> int:
        """The map that most frames were tracked in, the lower id of equals, as in the exports; NO_MAP without any."""
        map_ids = [frame.map_id for frame in self.tracked.values() if frame.state is TrackingState.TRACKING]
        if not map_ids:
            return NO_MAP
        values, counts = np.unique(map_ids, return_counts=True)
        return int(values[np.argmax(counts)])

    def live_trajectory(self) -> Trajectory | None:
        """The poses as slam said them frame by frame, in its main map; None where nothing was tracked.

        Where that map became metric on the way, those before are left out: they are in other units.
        """
        map_id = self.main_map_id()
        frames = [
            frame
            for _, frame in sorted(self.tracked.items())
            if frame.state is TrackingState.TRACKING and frame.map_from_camera is not None and frame.map_id == map_id
        ]
        poses = {
            frame.timestamp_ns: matrix_from_pose(frame.map_from_camera)
            for frame in frames
            if frame.map_from_camera is not None and frame.metric_scale == frames[-1].metric_scale
        }
        return _trajectory(poses, "live trajectory")

    def _score(self, sequence: int) -> None:
        if sequence in self._pending_truth and sequence in self._pending_objects:
            self._scored.add(sequence)
            self.moving_flag.add(self._pending_truth.pop(sequence), self._pending_objects.pop(sequence))
        for pending in (self._pending_truth, self._pending_objects):
            if len(pending) > _PENDING_FRAMES:
                pending.pop(min(pending))


def _trajectory(poses: dict[int, npt.NDArray[np.float64]], name: str) -> Trajectory | None:
    if not poses:
        return None
    times = sorted(poses)
    return Trajectory(np.array(times, dtype=np.int64), np.array([poses[time_ns] for time_ns in times]), name)
