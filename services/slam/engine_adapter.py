# SPDX-License-Identifier: Apache-2.0
"""The C++ engine in terms of the project's records: images and objects in, tracked frames and map updates out."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
import numpy.typing as npt

from schemas.categories import category_id
from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from schemas.records.camera import CameraCalibration, DepthImage, Image
from schemas.records.mapped_objects import MappedObjects
from schemas.records.objects import Objects
from schemas.records.slam import MapUpdate, MaskSource, TrackedFrame, TrackingState
from services.runtime.errors import InputError, ResourceError
from services.slam import _engine
from services.slam.object_mapper import ObjectMapper
from services.slam.vocabulary import SHIPPED_VOCABULARY

Stage = Literal["base", "dynamic", "moving"]

_LENSES = {"plumb_bob": _engine.Lens.plumb_bob, "kannala_brandt": _engine.Lens.kannala_brandt}
_OPTICAL_IN_REP103 = (0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5)


@dataclass(frozen=True)
class EngineSettings:
    """What a run may choose; `_engine.pyi` says what each is."""

    stage: Stage = "moving"
    features: int = 2000
    pyramid_levels: int = 8
    pyramid_factor: float = 1.2
    mask_border_px: int = 3
    seed: int = 0
    merge_delay_frames: int = 2
    local_bundle_keyframes: int = 15
    radial_sigma: float = 0.01
    velocity_change: float = 0.05
    threads: int = 2
    camera_height_m: float = 0.0
    new_map_after_lost: int = 50
    localize_only: bool = False
    opencv_threads: int = 1
    loop_closing: bool = True
    wait_for_loops: bool = True
    semi_dense: bool = False
    map_id: int = 0
    vocabulary_path: str = str(SHIPPED_VOCABULARY)
    map_from_first_camera: npt.NDArray[np.float64] = field(default_factory=lambda: np.array(_OPTICAL_IN_REP103))
    """(7,) tx ty tz qx qy qz qw; a level camera in a map with x forward, y left, z up (REP-103) unless given"""


class SlamEngine:
    """SLAM of one camera, a rectified pair or a depth camera. Not for two threads at once."""

    def __init__(
        self,
        calibration: CameraCalibration,
        settings: EngineSettings | None = None,
        right: CameraCalibration | None = None,
    ) -> None:
        """InputError names the number of the calibration or the setting that cannot be used.

        Args:
            calibration: of the camera, the left one of a pair.
            settings: None: the defaults.
            right: of the other camera of a rectified pair; its projection says the baseline.
        """
        self._settings = settings or EngineSettings()
        self._metric_scale = False
        self._depth: DepthImage | None = None
        self._calibration = calibration
        self._object_mapper = ObjectMapper(calibration)
        self._mapped_objects = MappedObjects(0)
        self._map_id = self._settings.map_id
        with _input_errors():
            self._engine = _engine.Engine(_camera_model(calibration, right), _engine_options(self._settings))

    def begin_frame(self, image: Image, right: Image | None = None, depth: DepthImage | None = None) -> None:
        """Extract the features of an image, with depths where a right or a depth image comes; it needs no objects yet.

        A frame begun but not finished is replaced. InputError when a size is not the calibration's, a right image comes
        to an engine that does not know the right camera, or the time is not after the last frame's.
        """
        self._depth = depth
        with _input_errors():
            self._engine.begin_frame(
                image.timestamp_ns,
                _grey(image.pixels),
                None if right is None else _grey(right.pixels),
                None if depth is None else np.ascontiguousarray(depth.depth_m, np.float32),
            )

    def finish_frame(self, objects: Objects | None, masks: MaskSource) -> TrackedFrame:
        """Track and map the frame begun last.

        Masks that are not fresh keep every object out of tracking, whatever its state (in the stages that know
        objects).
        InputError for arrays of another size; RuntimeError when no frame was begun.
        """
        rows = () if objects is None else objects.objects
        with _input_errors():
            result = self._engine.finish_frame(
                None if objects is None else np.ascontiguousarray(objects.track_image, np.uint32),
                np.array([row.object_id for row in rows], np.uint32),
                np.array([category_id(row.category) for row in rows], np.int32),
                np.array([row.motion_state for row in rows], np.uint8),
                masks is MaskSource.FRESH,
            )
        self._metric_scale = result.metric_scale
        self._map_id = result.map_id
        frame = self._tracked_frame(result, masks)
        contacts, road_distance_m = result.object_contacts, result.road_distance
        self._mapped_objects = self._object_mapper.look(frame, objects, self._depth, contacts, road_distance_m)
        return frame

    @property
    def mapped_objects(self) -> MappedObjects:
        """The objects of the frame finished last, in the map."""
        return self._mapped_objects

    def flush(self) -> None:
        """End the input: merge the background's work and adjust the whole map once more; takes seconds."""
        self._engine.flush()

    def load_maps(self, path: Path) -> None:
        """Begin in another session's maps; before any frame. InputError that names the file and what is wrong."""
        with _input_errors():
            self._engine.load_maps(str(path))

    def resume_maps(self, path: Path, first_free_map_id: int) -> None:
        """Begin in this session's maps, after a fall; ids from `first_free_map_id` << 32 on were never used."""
        with _input_errors():
            self._engine.resume_maps(str(path), first_free_map_id)

    def save_maps(self, path: Path, *, in_background: bool = False) -> None:
        """Write all maps into one file, atomically. ResourceError when it, or the one before it, cannot be written."""
        with _resource_errors():
            self._engine.save_maps(str(path), in_background)

    def settle(self) -> None:
        """Merge what the background holds, so that a checkpoint has it too."""
        self._engine.settle()

    def checkpoint(self, path: Path) -> None:
        """Write the whole state and go on from it, just as an engine that restores it does."""
        with _resource_errors():
            self._engine.checkpoint(str(path))
        self._object_mapper = ObjectMapper(self._calibration)

    def restore(self, path: Path) -> None:
        """Go on where an engine of the same settings made a checkpoint, to the last bit. InputError as `load_maps`."""
        with _input_errors():
            self._engine.restore(str(path))
        self._object_mapper = ObjectMapper(self._calibration)
        self._map_id = self._engine.active_map_id
        self._metric_scale = self._engine.metric_scale

    @property
    def next_map_id(self) -> int:
        """The number that the next map will have; higher ones were never used."""
        return self._engine.next_map_id

    @property
    def remaining_radial(self) -> float:
        """Radial distortion on top of the calibration, found in young maps or by `flush`; 0: not yet, or none."""
        return self._engine.remaining_radial

    def take_map_update(self, timestamp_ns: int) -> MapUpdate:
        """Everything of the map that changed since the last call, under the time of the newest frame."""
        return MapUpdate(
            timestamp_ns=timestamp_ns,
            map_id=self._map_id,
            metric_scale=self._metric_scale,
            **self._engine.take_map_update(),
        )

    def _tracked_frame(self, result: _engine.TrackingResult, masks: MaskSource) -> TrackedFrame:
        state = TrackingState(result.state)
        has_pose = state is TrackingState.TRACKING
        covariance = result.covariance
        return TrackedFrame(
            timestamp_ns=result.timestamp_ns,
            state=state,
            reason=result.reason,
            map_id=result.map_id,
            map_from_camera=pose_from_matrix(result.map_from_camera) if has_pose else None,
            covariance=covariance if has_pose and np.isfinite(covariance).all() else None,
            reference_keyframe_id=result.reference_keyframe_id,
            camera_from_reference=pose_from_matrix(result.camera_from_reference) if has_pose else None,
            features=result.features,
            tracked_landmarks=result.tracked_landmarks,
            keyframe_inserted=result.keyframe_inserted,
            masks=masks,
            metric_scale=result.metric_scale,
            handling=self._settings.stage,
            moving_unplaced=result.moving_unplaced,
            stage_ms=result.stage_ms,
            loop_closed=result.loop_closed,
            maps_merged=result.maps_merged,
        )


@contextmanager
def _input_errors() -> Iterator[None]:
    """The engine's ValueErrors name the value and what was expected; to the user they are wrong input."""
    try:
        yield
    except ValueError as error:
        raise InputError(str(error)) from error


@contextmanager
def _resource_errors() -> Iterator[None]:
    """A file that the disk does not take."""
    try:
        yield
    except RuntimeError as error:
        raise ResourceError(f"map file {error}") from error


def _camera_model(calibration: CameraCalibration, right: CameraCalibration | None) -> _engine.CameraModel:
    # An image without distortion is a pinhole's, whatever lens it had.
    lens = _engine.Lens.plumb_bob if not calibration.distortion else _LENSES[calibration.distortion_model]
    k = calibration.intrinsics
    return _engine.CameraModel(
        calibration.width,
        calibration.height,
        float(k[0, 0]),
        float(k[1, 1]),
        float(k[0, 2]),
        float(k[1, 2]),
        list(calibration.distortion),
        0.0 if right is None else _baseline_m(calibration, right),
        lens,
    )


def _baseline_m(left: CameraCalibration, right: CameraCalibration) -> float:
    """InputError for cameras that are no rectified pair."""
    names = ("width", "height", "distortion", "distortion_model")
    same = all(getattr(left, name) == getattr(right, name) for name in names)
    if not same or not np.allclose(left.intrinsics, right.intrinsics):
        raise InputError("right camera: expected the lens and the size of the left one (a rectified pair), got others")
    if right.projection is None or not right.projection[0, 3] < 0:
        raise InputError("right camera: expected a projection with -fx * baseline in its first row, got none")
    return float(-right.projection[0, 3] / right.projection[0, 0])


def _engine_options(settings: EngineSettings) -> _engine.EngineOptions:
    options = _engine.EngineOptions()
    if settings.stage not in ("base", "dynamic", "moving"):
        raise InputError(f"stage: expected base, dynamic or moving, got {settings.stage!r}")
    options.stage = getattr(_engine.Stage, settings.stage)
    options.features = settings.features
    options.pyramid_levels = settings.pyramid_levels
    options.pyramid_factor = settings.pyramid_factor
    options.mask_border_px = settings.mask_border_px
    options.seed = settings.seed
    options.merge_delay_frames = settings.merge_delay_frames
    options.local_bundle_keyframes = settings.local_bundle_keyframes
    options.radial_sigma = settings.radial_sigma
    options.velocity_change = settings.velocity_change
    options.threads = settings.threads
    options.camera_height_m = settings.camera_height_m
    options.new_map_after_lost = settings.new_map_after_lost
    options.localize_only = settings.localize_only
    options.opencv_threads = settings.opencv_threads
    options.loop_closing = settings.loop_closing
    options.wait_for_loops = settings.wait_for_loops
    options.semi_dense = settings.semi_dense
    options.map_id = settings.map_id
    options.vocabulary_path = settings.vocabulary_path
    options.map_from_first_camera = matrix_from_pose(settings.map_from_first_camera)
    return options


def _grey(pixels: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    if pixels.ndim == 3 and pixels.shape[2] == 3 and pixels.dtype == np.uint8:
        return np.asarray(cv2.cvtColor(np.ascontiguousarray(pixels), cv2.COLOR_BGR2GRAY), np.uint8)
    return np.ascontiguousarray(pixels)
