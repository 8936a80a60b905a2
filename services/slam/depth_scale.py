# SPDX-License-Identifier: Apache-2.0
"""Metres for a map that began without: how far its landmarks are in the depth images of its keyframes.

The engine sets the scale by the depth image of its second keyframe, and never again. Where the sensor reaches less far
than the first landmarks lie (13 m in 16 bits at 5000 levels a metre, on a street whose corners are farther), such a map
would stay without metres for good.
"""

from dataclasses import replace

import cv2
import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose
from schemas.records.camera import CameraCalibration, DepthImage
from schemas.records.objects import MotionState
from schemas.records.slam import MapUpdate, TrackedFrame

_LEAST_LANDMARKS = 30
_STANDING = (MotionState.STATIC, MotionState.NON_MOVING)
_KEYFRAME_COLUMNS = ("id", "timestamp_ns", "map_id", "pose", "culled", "parent_id")

Array = npt.NDArray[np.float64]


class DepthScale:
    """The scale of one map: found once, from `_LEAST_LANDMARKS` on, and used from the frame after that on.

    Then every keyframe is sent again as the Sim(3) that it is in metres; landmarks and frames, which are relative to
    their keyframes, stay as they are.

    Args:
        calibration: of the images; depth images lie on their pixels.
        origin: (3,), the first camera in the map; it stays where it is.
    """

    def __init__(self, calibration: CameraCalibration, origin: Array) -> None:
        self._calibration = calibration
        self._origin = origin
        self._keyframes: dict[int, tuple[np.generic, ...]] = {}
        self._ratios: dict[int, float] = {}
        self._found: float | None = None
        self._metres_per_unit: float | None = None
        self._all_are_due = False

    @property
    def is_known(self) -> bool:
        """Whether what `frame` and `update` give is in metres."""
        return self._metres_per_unit is not None

    def frame(self, in_units: TrackedFrame) -> TrackedFrame:
        """The frame in metres, if a frame before it made them known; `camera_from_reference` stays in units."""
        if self._found is not None and self._metres_per_unit is None:
            self._metres_per_unit, self._all_are_due = self._found, True
        scale = self._metres_per_unit
        if scale is None:
            return in_units
        pose, covariance = in_units.map_from_camera, in_units.covariance
        step = np.array([scale, scale, scale, 1.0, 1.0, 1.0])
        return replace(
            in_units,
            map_from_camera=None if pose is None else np.concatenate((self._in_metres(pose[:3], scale), pose[3:])),
            covariance=None if covariance is None else covariance * np.outer(step, step),
            metric_scale=True,
        )

    def update(self, in_units: MapUpdate) -> MapUpdate:
        """The update in metres, where they are known; the first such one holds every keyframe of the map."""
        columns = [getattr(in_units, f"keyframe_{name}") for name in _KEYFRAME_COLUMNS]
        self._keyframes.update((int(row[0]), row) for row in zip(*columns, strict=True))
        scale = self._metres_per_unit
        if scale is None:
            return in_units
        if self._all_are_due:
            rows = [self._keyframes[number] for number in sorted(self._keyframes)]
            columns = [
                np.array(column, had.dtype) for column, had in zip(zip(*rows, strict=True), columns, strict=True)
            ]
            self._all_are_due = False
        named = dict(zip((f"keyframe_{name}" for name in _KEYFRAME_COLUMNS), columns, strict=True))
        poses = named["keyframe_pose"].copy()
        poses[:, :3] = self._in_metres(poses[:, :3], scale)
        poses[:, 7] *= scale
        return replace(in_units, metric_scale=True, **{**named, "keyframe_pose": poses})

    def look(self, in_units: MapUpdate, map_from_camera: Array, depth: DepthImage) -> None:
        """Measure the landmarks of an update that the keyframe of this depth image has observed.

        Args:
            in_units: the update of the keyframe's own frame.
            map_from_camera: (7,) of the keyframe, in map units.
            depth: of the same frame.
        """
        if self._found is not None:
            return
        seen = (in_units.landmark_last_seen_ns == depth.timestamp_ns) & np.isin(in_units.landmark_state, _STANDING)
        if not seen.any():
            return
        in_camera = self._in_camera(in_units, np.flatnonzero(seen), map_from_camera)
        measured_m = self._depths_at(in_camera, depth.depth_m)
        known = measured_m > 0
        ratios = measured_m[known] / in_camera[known, 2]
        self._ratios.update(zip(in_units.landmark_id[seen][known].tolist(), ratios.tolist(), strict=True))
        if len(self._ratios) >= _LEAST_LANDMARKS:
            self._found = float(np.median(list(self._ratios.values())))

    def _in_camera(self, in_units: MapUpdate, rows: npt.NDArray[np.intp], map_from_camera: Array) -> Array:
        """(N, 3) of the update's landmarks, in map units."""
        camera_from_map = np.linalg.inv(matrix_from_pose(map_from_camera))
        anchors, anchor_of = np.unique(in_units.landmark_anchor_id[rows], return_inverse=True)
        camera_from_anchor = np.array([camera_from_map @ matrix_from_pose(self._pose_of(int(one))) for one in anchors])
        own = camera_from_anchor[anchor_of]
        position = in_units.landmark_position[rows].astype(np.float64)
        return np.asarray(np.einsum("nij,nj->ni", own[:, :3, :3], position) + own[:, :3, 3])

    def _pose_of(self, keyframe_id: int) -> Array:
        return np.asarray(self._keyframes[keyframe_id][_KEYFRAME_COLUMNS.index("pose")], dtype=np.float64)

    def _in_metres(self, position: Array, scale: float) -> Array:
        return self._origin + scale * (position - self._origin)

    def _depths_at(self, in_camera: Array, depth_m: npt.NDArray[np.float32]) -> Array:
        """(N,) metres where the points fall into the image as it came, distorted; 0 where there is no depth."""
        none, distortion = np.zeros(3), np.array(self._calibration.distortion)
        pixels, _ = cv2.projectPoints(in_camera.reshape(-1, 1, 3), none, none, self._calibration.intrinsics, distortion)
        # A point at the camera's own place has no pixel.
        column, row = np.rint(np.nan_to_num(pixels.reshape(-1, 2), nan=-1.0, posinf=-1.0, neginf=-1.0)).T
        height, width = depth_m.shape
        inside = (column >= 0) & (row >= 0) & (column < width) & (row < height) & (in_camera[:, 2] > 0)
        measured_m = np.zeros(len(in_camera))
        measured_m[inside] = depth_m[row[inside].astype(np.intp), column[inside].astype(np.intp)]
        return np.where(np.isfinite(measured_m), measured_m, 0.0)
