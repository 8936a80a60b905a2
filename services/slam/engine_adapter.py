# SPDX-License-Identifier: Apache-2.0
"""The C++ engine in the records of the pipeline: numpy arrays in, TrackedFrame and MapUpdate out."""

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
import numpy.typing as npt

from schemas.categories import category_id
from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from schemas.records import (
    CameraCalibration,
    DepthImage,
    Image,
    MapUpdate,
    MaskSource,
    Objects,
    TrackedFrame,
    TrackingState,
)
from services.slam import _engine

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class EngineSettings:
    """What a user may choose of the engine; see services/runtime/config/slam.py."""

    stage: Literal["base", "dynamic", "moving"]
    features: int
    pyramid_levels: int
    pyramid_factor: float
    seed: int
    merge_delay_frames: int
    map_from_first_camera: Array
    """(7,) tx ty tz qx qy qz qw"""
    map_id: int = 0


class SlamEngine:
    """One map being made from one camera."""

    def __init__(self, calibration: CameraCalibration, settings: EngineSettings) -> None:
        """Raises ValueError for a calibration or an option that the engine cannot use, naming it."""
        k = calibration.intrinsics
        camera = _engine.CameraModel(
            calibration.width, calibration.height, k[0, 0], k[1, 1], k[0, 2], k[1, 2], list(calibration.distortion)
        )
        options = _engine.EngineOptions()
        options.stage = getattr(_engine.Stage, settings.stage)
        options.features = settings.features
        options.pyramid_levels = settings.pyramid_levels
        options.pyramid_factor = settings.pyramid_factor
        options.seed = settings.seed
        options.merge_delay_frames = settings.merge_delay_frames
        options.map_id = settings.map_id
        options.map_from_first_camera = matrix_from_pose(settings.map_from_first_camera)
        self._stage = settings.stage
        self._map_id = settings.map_id
        self._metric_scale = False
        self._engine = _engine.Engine(camera, options)

    def begin_frame(self, image: Image) -> None:
        """Extract the image's features; needs no masks yet. Raises ValueError for an image of another size."""
        pixels = image.pixels
        grey = pixels if pixels.ndim == 2 else cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
        self._engine.begin_frame(image.timestamp_ns, np.ascontiguousarray(grey))

    def finish_frame(self, objects: Objects | None, masks: MaskSource, depth: DepthImage | None) -> TrackedFrame:
        """Track the frame begun. `objects` None: nothing is known of this frame's objects."""
        rows = () if objects is None else objects.objects
        result = self._engine.finish_frame(
            None if objects is None else np.ascontiguousarray(objects.track_image, dtype=np.uint32),
            np.array([row.object_id for row in rows], dtype=np.uint32),
            np.array([category_id(row.category) for row in rows], dtype=np.int32),
            np.array([row.motion_state for row in rows], dtype=np.uint8),
            masks is MaskSource.FRESH,
            None if depth is None else np.ascontiguousarray(depth.depth_m, dtype=np.float32),
        )
        tracked = result.state == TrackingState.TRACKING
        self._metric_scale = result.metric_scale
        return TrackedFrame(
            timestamp_ns=result.timestamp_ns,
            state=TrackingState(result.state),
            reason=result.reason,
            map_id=result.map_id,
            map_from_camera=pose_from_matrix(result.map_from_camera) if tracked else None,
            covariance=result.covariance if tracked else None,
            reference_keyframe_id=result.reference_keyframe_id if tracked else -1,
            camera_from_reference=pose_from_matrix(result.camera_from_reference) if tracked else None,
            features=result.features,
            tracked_landmarks=result.tracked_landmarks,
            keyframe_inserted=result.keyframe_inserted,
            masks=masks,
            metric_scale=result.metric_scale,
            handling=self._stage,
            moving_unplaced=result.moving_unplaced,
            stage_ms=dict(result.stage_ms),
        )

    def flush(self) -> None:
        """The input is over: wait for what the engine still optimises, and merge it."""
        self._engine.flush()

    def take_map_update(self, timestamp_ns: int) -> MapUpdate:
        """Everything of the map that changed since this was called last."""
        return MapUpdate(timestamp_ns, self._map_id, self._metric_scale, **self._engine.take_map_update())
