# SPDX-License-Identifier: Apache-2.0
"""The slam process: `python -m services.slam.service --config FILE`."""

from pathlib import Path
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
from services.slam.map_keeper import MapKeeper

NAME = "slam"


class SlamService(FrameService):
    """Drives the engine: a pose for every frame, and what changed of the map. A killed one goes on in the same map."""

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
        self._calibration: CameraCalibration | None = None
        self._right_calibration: CameraCalibration | None = None
        self._keeper = MapKeeper(config, self.awaits)
        self._sequence = -1
        self._ended = False
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
        self._keeper.note_input(bundle)
        outgoing = self._track(bundle)
        self._sequence = bundle.envelope.sequence
        return outgoing

    def _track(self, bundle: Bundle) -> list[Outgoing]:
        engine = self._engine_for(bundle)
        right = bundle.get(topics.IMAGE_RIGHT) if self._right_calibration is not None else None
        depth = bundle.get(topics.DEPTH) if self._options.use_depth else None
        engine.begin_frame(bundle[topics.IMAGE], right, depth)
        objects, masks = self._masks(bundle.get(topics.OBJECTS))
        frame = engine.finish_frame(objects, masks)
        self._note(frame)
        self._keeper.prepare(engine, frame)
        update = engine.take_map_update(bundle.timestamp_ns)
        self._keeper.keep(engine, bundle)
        outgoing = [
            Outgoing(topics.TRACKED_FRAME, frame),
            Outgoing(topics.MAP_UPDATE, update),
            Outgoing(topics.MAPPED_OBJECTS, engine.mapped_objects),
        ]
        if frame.map_from_camera is not None:
            outgoing.append(Outgoing(topics.POSE, self._base_pose(frame)))
        return outgoing

    def finish(self, bundle: Bundle) -> list[Outgoing]:
        """The input is over: merge what is still being optimised, and send it."""
        self._sequence = bundle.envelope.sequence
        if self._engine is None:
            return [Outgoing(topics.MAP_UPDATE, MapUpdate(bundle.timestamp_ns, self._map_id))]
        self._engine.flush()
        self._log.info("adjusted_at_the_end", remaining_radial=f"{self._engine.remaining_radial:.5f}")
        update = self._engine.take_map_update(bundle.timestamp_ns)
        self._end()
        return [Outgoing(topics.MAP_UPDATE, update)]

    def keep_state_in(self, folder: Path) -> None:
        """Checkpoints go there."""
        self._keeper.keep_in(folder)

    def snapshot(self) -> State:
        """Which checkpoint the newest frame goes back to, and how far the session is."""
        numbers = {"sequence": self._sequence, "map_id": self._map_id, "ended": int(self._ended)}
        return {**self._keeper.snapshot(), **{name: np.array(number, np.int64) for name, number in numbers.items()}}

    def restore(self, state: State) -> None:
        """Take up the predecessor's engine, or, where no checkpoints are made, begin the next map."""
        self._map_id = int(state["map_id"])
        if not self._keeper.is_exact:
            self._map_id += 1
            self._log.warning("new_map_after_restart", map_id=self._map_id)
            return
        self._sequence, self._ended = int(state["sequence"]), bool(state["ended"])
        checkpoint, frames = self._keeper.restore(state)
        for bundle in frames:
            if self._engine is None:
                self._engine_for(bundle, checkpoint)
            if bundle.envelope.sequence > self._keeper.checkpoint:
                self._track(bundle)
        self._log.warning("state_restored", checkpoint=self._keeper.checkpoint, sequence=self._sequence)

    def close(self) -> None:
        """Save the map where the input never said that it was over."""
        self._end()

    def metrics(self) -> dict[str, float]:
        """What happened so far."""
        return dict(self._counts)

    def _end(self) -> None:
        if self._engine is not None and not self._ended:
            self._ended = True
            self._keeper.end(self._engine)

    def _engine_for(self, bundle: Bundle, checkpoint: Path | None = None) -> SlamEngine:
        calibration = bundle[topics.CALIBRATION]
        right = bundle.get(topics.CALIBRATION_RIGHT) if self._options.use_stereo else None
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
            velocity_change=options.velocity_change,
            loop_closing=options.loop_closing,
            wait_for_loops=self._lossless,
            semi_dense=options.semi_dense,
            camera_height_m=options.camera_height_m or 0.0,
            new_map_after_lost=options.new_map_after_lost,
            localize_only=options.localize_only,
            map_from_first_camera=self._base_from_camera,
            map_id=self._map_id,
        )
        self._engine = SlamEngine(calibration, settings, right)
        self._calibration, self._right_calibration = calibration, right
        if checkpoint is not None:
            self._engine.restore(checkpoint)
        else:
            self._keeper.begin(self._engine)
        return self._engine

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
        if frame.map_id != self._map_id:
            self._log.warning("another_map", map_id=frame.map_id, before=self._map_id)
            self._map_id = frame.map_id
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
