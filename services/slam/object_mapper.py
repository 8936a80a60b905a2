# SPDX-License-Identifier: Apache-2.0
"""Each frame's objects in the map: what the engine, the masks and the depth image say of them, put together."""

import cv2
import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose
from schemas.records.camera import CameraCalibration, DepthImage
from schemas.records.mapped_objects import MappedObjects
from schemas.records.objects import Objects
from schemas.records.slam import MaskSource, TrackedFrame
from services.slam.object_tracks import CameraView, ObjectTracks

Array = npt.NDArray[np.float64]


class ObjectMapper:
    """The objects of one camera's frames. They are placed once the map is in metres, in frames with fresh masks."""

    def __init__(self, calibration: CameraCalibration) -> None:
        self._intrinsics = calibration.intrinsics
        self._distortion = np.array(calibration.distortion)
        self._model = calibration.distortion_model
        self._tracks = ObjectTracks()
        self._map_id: int | None = None

    def look(
        self,
        frame: TrackedFrame,
        objects: Objects | None,
        depth: DepthImage | None,
        contacts: dict[int, Array],
        road_distance_m: float,
    ) -> MappedObjects:
        """The objects of a tracked frame.

        Args:
            frame: with the pose that the map has for it now.
            objects: as they were given with the frame.
            depth: of the frame, if there is one.
            contacts: object id -> where it stands on the road (3, 3), camera frame, in the frame's units.
            road_distance_m: of the camera above the road; 0: not known.
        """
        nothing = MappedObjects(frame.timestamp_ns, frame.map_id, frame.metric_scale)
        if frame.map_id != self._map_id:
            self._tracks.forget()
            self._map_id = frame.map_id
        if not frame.metric_scale or frame.map_from_camera is None:
            self._tracks.forget()
            return nothing
        if objects is None or frame.masks is not MaskSource.FRESH:
            return nothing
        view = CameraView(
            matrix_from_pose(frame.map_from_camera), float(self._intrinsics[0, 0]), road_distance_m, self._rays_of
        )
        depth_m = None if depth is None else depth.depth_m
        mapped = self._tracks.update(objects, view, contacts, depth_m)
        return MappedObjects(frame.timestamp_ns, frame.map_id, frame.metric_scale, mapped)

    def _rays_of(self, pixels: Array) -> Array:
        points = pixels.reshape(-1, 1, 2)
        if self._model == "kannala_brandt":
            rays = cv2.fisheye.undistortPoints(points, self._intrinsics, self._distortion)
        else:
            rays = cv2.undistortPoints(points, self._intrinsics, self._distortion)
        return np.asarray(rays, np.float64).reshape(-1, 2)
