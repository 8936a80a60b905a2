# SPDX-License-Identifier: Apache-2.0
"""The slam process: `python -m services.slam.service --config FILE`."""

from typing import ClassVar

import numpy as np

from schemas import topics
from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from schemas.records import CameraCalibration, MapUpdate, MaskSource, Objects, PoseInMap, TrackedFrame, TrackingState
from schemas.topics import Topic
from services.runtime.config import Config
from services.runtime.errors import InputError
from services.runtime.host import run_service
from services.runtime.log import get_logger
from services.runtime.outbox import State
from services.runtime.service import Bundle, FrameService, Outgoing
from services.slam.engine_adapter import EngineSettings, SlamEngine
from services.slam.lost_policy import LostPolicy

NAME = "slam"


class SlamService(FrameService):
    """Drives the engine: a pose for every frame, and what changed of the map.

    The engine's own state is not kept on disk yet: after a kill, tracking begins a new map in the same session, and
    nothing already sent is lost.
    """

    name: ClassVar[str] = NAME
    awaits: ClassVar[tuple[Topic, ...]] = (
        topics.IMAGE,
        topics.IMAGE_RIGHT,
        topics.CALIBRATION,
        topics.CALIBRATION_RIGHT,
        topics.DEPTH,
        topics.OBJECTS,
    )
    deferrable: ClassVar[tuple[Topic, ...]] = (topics.OBJECTS,)
    answers: ClassVar[bool] = True

    def __init__(self, config: Config) -> None:
        self._options = config.slam
        self._lossless = config.delivery.mode == "lossless"
        self._base_from_camera = np.array(config.mapstore.base_from_camera)
        self._log = get_logger(NAME)
        self._engine: SlamEngine | None = None
        self._lost_policy = LostPolicy(config.slam.new_map_after_lost)
        self._calibration: CameraCalibration | None = None
        self._right_calibration: CameraCalibration | None = None
        self._map_id = 0
        self._objects: Objects | None = None
        self._state = TrackingState.INITIALIZING
        self._counts = {
            "keyframes_inserted": 0.0,
            "frames_lost": 0.0,
            "moving_unplaced": 0.0,
            "loops_closed": 0.0,
            "maps_merged": 0.0,
        }

    def process(self, bundle: Bundle) -> list[Outgoing]:
        """Track one frame."""
        right_calibration = bundle.get(topics.CALIBRATION_RIGHT) if self._options.use_stereo else None
        engine = self._engine_for(bundle[topics.CALIBRATION], right_calibration)
        right = bundle.get(topics.IMAGE_RIGHT) if self._right_calibration is not None else None
        depth = bundle.get(topics.DEPTH) if self._options.use_depth else None
        engine.begin_frame(bundle[topics.IMAGE], right, depth)
        objects, masks = self._masks(bundle.get(topics.OBJECTS))
        frame = engine.finish_frame(objects, masks)
        self._note(frame)
        if self._lost_policy.gives_up(frame):
            self._begin_new_map(engine)
        update = engine.take_map_update(bundle.timestamp_ns)
        outgoing = [Outgoing(topics.TRACKED_FRAME, frame), Outgoing(topics.MAP_UPDATE, update)]
        if engine.mapped_objects.objects:
            outgoing.append(Outgoing(topics.MAPPED_OBJECTS, engine.mapped_objects))
        if frame.map_from_camera is not None:
            outgoing.append(Outgoing(topics.POSE, self._base_pose(frame)))
        return outgoing

    def finish(self, bundle: Bundle) -> list[Outgoing]:
        """The input is over: merge what is still being optimised, and send it."""
        if self._engine is None:
            return [Outgoing(topics.MAP_UPDATE, MapUpdate(bundle.timestamp_ns, self._map_id))]
        self._engine.flush()
        self._log.info("adjusted_at_the_end", remaining_radial=f"{self._engine.remaining_radial:.5f}")
        return [Outgoing(topics.MAP_UPDATE, self._engine.take_map_update(bundle.timestamp_ns))]

    def snapshot(self) -> State:
        """The map's number, so that a successor's ids are new ones."""
        return {"map_id": np.array(self._map_id, dtype=np.int64)}

    def restore(self, state: State) -> None:
        """Begin the next map."""
        self._map_id = int(state["map_id"]) + 1
        self._log.warning("new_map_after_restart", map_id=self._map_id)

    def metrics(self) -> dict[str, float]:
        """What happened so far."""
        return dict(self._counts)

    def _engine_for(self, calibration: CameraCalibration, right: CameraCalibration | None) -> SlamEngine:
        known = self._calibration
        if self._engine is not None and known is not None:
            if not _same_camera(known, calibration) or not _same_pair(self._right_calibration, right):
                raise InputError("the camera's calibration changed within a session, expected one camera a session")
            return self._engine
        options = self._options
        settings = EngineSettings(
            stage=options.stage,
            features=options.features,
            pyramid_levels=options.pyramid_levels,
            pyramid_factor=options.pyramid_factor,
            seed=options.seed,
            merge_delay_frames=options.merge_delay_frames,
            radial_sigma=options.radial_sigma,
            loop_closing=options.loop_closing,
            wait_for_loops=self._lossless,
            semi_dense=options.semi_dense,
            camera_height_m=options.camera_height_m or 0.0,
            map_from_first_camera=self._base_from_camera,
            map_id=self._map_id,
        )
        self._engine = SlamEngine(calibration, settings, right)
        self._calibration, self._right_calibration = calibration, right
        return self._engine

    def _begin_new_map(self, engine: SlamEngine) -> None:
        """Finish the map of `engine`; the next frame begins another with ids of its own."""
        engine.flush()
        self._engine = None
        self._map_id += 1
        self._lost_policy = LostPolicy(self._options.new_map_after_lost)
        self._log.warning("new_map_after_lost", map_id=self._map_id)

    def _masks(self, objects: Objects | None) -> tuple[Objects | None, MaskSource]:
        """This frame's objects, else the newest there are, and which of the two."""
        if objects is not None:
            self._objects = objects
            return objects, MaskSource.FRESH if objects.masks_age_frames == 0 else MaskSource.CARRIED
        return self._objects, MaskSource.NO_MASKS if self._objects is None else MaskSource.CARRIED

    def _base_pose(self, frame: TrackedFrame) -> PoseInMap:
        assert frame.map_from_camera is not None
        base_from_camera = matrix_from_pose(self._base_from_camera)
        if not frame.metric_scale:
            base_from_camera[:3, 3] = 0.0  # metres mean nothing in a map without metres
        map_from_base = matrix_from_pose(frame.map_from_camera) @ np.linalg.inv(base_from_camera)
        return PoseInMap(frame.timestamp_ns, pose_from_matrix(map_from_base))

    def _note(self, frame: TrackedFrame) -> None:
        if frame.state is not self._state:
            self._log.info("tracking_state", state=frame.state.name.lower(), reason=frame.reason or "-")
            self._state = frame.state
        if frame.loop_closed:
            self._log.info("loop_closed", map_id=frame.map_id, timestamp_ns=frame.timestamp_ns)
        if frame.maps_merged:
            self._log.info("maps_merged", map_id=frame.map_id, timestamp_ns=frame.timestamp_ns)
        self._counts["loops_closed"] += frame.loop_closed
        self._counts["maps_merged"] += frame.maps_merged
        self._counts["keyframes_inserted"] += frame.keyframe_inserted
        self._counts["frames_lost"] += frame.state is TrackingState.LOST
        self._counts["moving_unplaced"] += frame.moving_unplaced


def _same_camera(one: CameraCalibration, other: CameraCalibration) -> bool:
    names = ("width", "height", "distortion", "distortion_model")
    same = all(getattr(one, name) == getattr(other, name) for name in names)
    return same and np.array_equal(one.intrinsics, other.intrinsics)


def _same_pair(known: CameraCalibration | None, right: CameraCalibration | None) -> bool:
    """A right camera may stay silent; one that was not there at first must not come."""
    return right is None or (known is not None and _same_camera(known, right))


if __name__ == "__main__":
    run_service(SlamService, NAME)
