# SPDX-License-Identifier: Apache-2.0
"""The true surface of what a camera saw, as labelled points, out of true depth, poses and objects."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, DepthImage, MotionState, TrueInstances, TruePose
from services.formats.point_cloud import LabelledPoints, first_in_voxels
from services.runtime.errors import InputError


@dataclass(frozen=True)
class SurfaceOptions:
    """How densely the surface is taken. What moves is taken in every frame, for it is elsewhere in the next."""

    every_frames: int = 5
    """of what stands"""
    voxel_m: float = 0.1
    farthest_m: float = 40.0
    """from the camera; farther away neighbouring pixels are more than a voxel apart"""

    def __post_init__(self) -> None:
        for name, value in (("voxel", self.voxel_m), ("farthest", self.farthest_m)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{name} {value:g} m, expected a number above 0")
        if self.every_frames < 1:
            raise InputError(f"every {self.every_frames} frames, expected at least 1")


class BackProjection:
    """Brings the pixels of one camera into the world. Pixels are distorted as the calibration says (OpenCV)."""

    def __init__(self, calibration: CameraCalibration) -> None:
        columns, rows = np.meshgrid(np.arange(calibration.width), np.arange(calibration.height))
        pixels = np.stack((columns, rows), axis=-1).astype(np.float64)
        if calibration.distortion:
            distortion = np.array(calibration.distortion, dtype=np.float64)
            flat = cv2.undistortPoints(pixels.reshape(-1, 1, 2), calibration.intrinsics, distortion)
            plane = flat.reshape(pixels.shape)
        else:
            k = calibration.intrinsics
            plane = (pixels - (k[0, 2], k[1, 2])) / (k[0, 0], k[1, 1])
        self._rays = np.concatenate((plane, np.ones((*plane.shape[:2], 1))), axis=2)

    def points(
        self, depth: DepthImage, pose: TruePose, truth: TrueInstances, chosen: npt.NDArray[np.bool_]
    ) -> LabelledPoints:
        """The surface (world frame, metres) at the `chosen` pixels (H, W) and what each is part of at that time.

        Raises InputError where the images are of different sizes.
        """
        if not depth.depth_m.shape == truth.labels.shape == self._rays.shape[:2]:
            raise InputError(
                f"depth of {depth.depth_m.shape} and labels of {truth.labels.shape} at {depth.timestamp_ns} ns,"
                f" expected {self._rays.shape[:2]} as in the calibration"
            )
        in_camera = self._rays[chosen] * depth.depth_m[chosen].astype(np.float64)[:, None]
        world_from_camera = pose.world_from_camera
        in_world = in_camera @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
        labels = truth.labels[chosen]
        state = np.where(labels == 0, MotionState.STATIC, MotionState.NON_MOVING).astype(np.uint8)
        state[np.isin(labels, [row.instance_id for row in truth.objects if row.moving])] = MotionState.MOVING
        return LabelledPoints(in_world, state)


def thinned(clouds: Sequence[LabelledPoints], voxel_m: float) -> LabelledPoints:
    """The first point of every state in every voxel, in the order of the clouds. Raises InputError for tiny voxels."""
    position = np.concatenate([np.empty((0, 3)), *(cloud.position for cloud in clouds)])
    state = np.concatenate([np.empty(0, dtype=np.uint8), *(cloud.state for cloud in clouds)])
    first = first_in_voxels(position, state, voxel_m)
    return LabelledPoints(position[first], state[first], "surface")
