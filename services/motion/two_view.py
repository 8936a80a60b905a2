# SPDX-License-Identifier: Apache-2.0
"""What a camera's motion between two images says about a point that stands still (Hartley and Zisserman, ch. 9)."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PinholeCamera:
    """`intrinsics` (3, 3) in px and OpenCV's `distortion`: k1, k2, p1, p2, k3, or k1 to k4 of a fisheye, or none."""

    intrinsics: FloatArray
    distortion: tuple[float, ...] = ()
    fisheye: bool = False

    @property
    def focal_px(self) -> float:
        """The mean focal length."""
        return float(np.sqrt(self.intrinsics[0, 0] * self.intrinsics[1, 1]))

    def normalise(self, pixels: npt.NDArray[np.floating]) -> FloatArray:
        """Normalised, undistorted image coordinates (N, 2) of `pixels` (N, 2)."""
        if any(self.distortion):
            points = np.ascontiguousarray(pixels, dtype=np.float64).reshape(-1, 1, 2)
            undistort = cv2.fisheye.undistortPoints if self.fisheye else cv2.undistortPoints
            undistorted = undistort(points, self.intrinsics, np.array(self.distortion))
            return np.asarray(undistorted.reshape(-1, 2), dtype=np.float64)
        focal = np.array([self.intrinsics[0, 0], self.intrinsics[1, 1]])
        return np.asarray((pixels - self.intrinsics[:2, 2]) / focal, dtype=np.float64)


@dataclass(frozen=True)
class CameraMotion:
    """X_previous = rotation @ X_current + translation, camera optical frames.

    `translation` has unit length (the scale of two views is arbitrary), or is zero where the camera only turned.
    """

    rotation: FloatArray
    translation: FloatArray

    @property
    def has_baseline(self) -> bool:
        """Whether the camera changed its place, so that depth and epipolar lines exist."""
        return bool(np.any(self.translation))


@dataclass(frozen=True)
class Parallax:
    """Displacements (N,), in normalised image coordinates, of points from where pure rotation would have put them.

    `along` and `across` are its parts along the epipolar line (positive: as a point in front of the camera moves) and
    across it. `inverse_depth` is that of the point in the current camera, 1 / baseline: it is `along` explained by a
    depth, and negative where no depth in front of the camera explains it. `gain` is d along / d inverse_depth.
    Without baseline `along` and `across` are the vertical and horizontal displacement, and the other two are zero.
    """

    along: FloatArray
    across: FloatArray
    inverse_depth: FloatArray
    gain: FloatArray

    @property
    def length(self) -> FloatArray:
        """The displacement's length, (N,) in normalised image coordinates."""
        return np.hypot(self.along, self.across)


def measure_parallax(motion: CameraMotion, current: FloatArray, previous: FloatArray) -> Parallax:
    """Split the displacement of normalised points (N, 2) seen at `current` and, one image before, at `previous`."""
    rotated = current @ motion.rotation[:, :2].T + motion.rotation[:, 2]
    depth_change = rotated[:, 2]
    displacement = previous - rotated[:, :2] / depth_change[:, None]
    if not motion.has_baseline:
        zeros = np.zeros(len(current))
        return Parallax(displacement[:, 1], displacement[:, 0], zeros, zeros)
    line = motion.translation[:2] - previous * motion.translation[2]
    length = np.maximum(np.hypot(line[:, 0], line[:, 1]), 1e-9)
    line /= length[:, None]
    along = np.einsum("ij,ij->i", displacement, line)
    across = displacement[:, 0] * line[:, 1] - displacement[:, 1] * line[:, 0]
    inverse_depth = along * depth_change / length
    gain = length / np.maximum(depth_change + inverse_depth * motion.translation[2], 1e-3)
    return Parallax(along, across, inverse_depth, gain)


def predict_along(motion: CameraMotion, current: FloatArray, inverse_depth: FloatArray) -> FloatArray:
    """`along` of standing points at normalised `current` (N, 2) with `inverse_depth` (N,), 1 / baseline."""
    rotated = current @ motion.rotation[:, :2].T + motion.rotation[:, 2]
    moved = rotated + inverse_depth[:, None] * motion.translation
    start = rotated[:, :2] / rotated[:, 2:]
    end = moved[:, :2] / np.maximum(moved[:, 2:], 1e-3)
    return np.asarray(np.hypot(*(end - start).T) * np.sign(inverse_depth))


def rotation_from_vector(vector: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of a rotation vector (3,), rad."""
    return np.asarray(cv2.Rodrigues(np.asarray(vector, dtype=np.float64))[0], dtype=np.float64)
