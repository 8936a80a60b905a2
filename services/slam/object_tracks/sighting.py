# SPDX-License-Identifier: Apache-2.0
"""Where one object is in one frame, by where it touches the road or by the depth image."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.slam.object_tracks.size_priors import Size

Array = npt.NDArray[np.float64]

_LEAST_DEPTH_PIXELS = 20
_NEAR_PERCENTILE = 10
_CONTACT_PX = 1.5  # how well a mask's lower edge is known
_SIDE_M = 0.3
_END_ON = 0.2  # rad; nearer to the line of sight a heading shows one end of the object only


@dataclass(frozen=True)
class CameraView:
    """One frame: the camera in the map, its focal length, and what measures distance in it."""

    map_from_camera: Array
    """(4, 4), metres"""
    focal_px: float
    road_distance_m: float
    """of the camera above the road; 0: not known"""
    rays_of: Callable[[Array], Array]
    """(N, 2) pixels of the image as it came -> (N, 2) x / z and y / z, camera frame"""


@dataclass(frozen=True)
class Outline:
    """What is seen of an object's footprint: left end, nearest point, right end (3, 3), camera frame, metres."""

    points: Array
    by_depth: bool


@dataclass(frozen=True)
class Sighting:
    """One object's place in one frame, map frame."""

    center: Array
    """(3,) middle of the footprint, metres"""
    covariance: Array
    """(2, 2) of x and y"""
    side_heading_rad: float | None
    """of the longest side that is seen; None when it is seen end-on"""
    extent_m: float
    """across the line of sight"""
    near_m: float
    """to the nearest point"""


def outline_by_depth(mask: npt.NDArray[np.bool_], depth_m: npt.NDArray[np.float32], view: CameraView) -> Outline | None:
    """The near surface of a mask (H, W), from a depth image (H, W) with 0, or no number, where it knows nothing."""
    known = mask & np.isfinite(depth_m) & (depth_m > 0)
    if np.count_nonzero(known) < _LEAST_DEPTH_PIXELS:
        return None
    depths = depth_m[known].astype(np.float64)
    near = float(np.percentile(depths, _NEAR_PERCENTILE))
    columns = np.flatnonzero(mask.any(axis=0))
    lowest = np.flatnonzero(mask.any(axis=1))[-1]
    middle = (columns[0] + columns[-1]) / 2
    rays = view.rays_of(np.array([[column, lowest] for column in (columns[0], middle, columns[-1])], np.float64))
    return Outline(near * np.column_stack((rays, np.ones(3))), by_depth=True)


def sight(outline: Outline, view: CameraView, size: Size, heading_rad: float | None, inset_m: float = 0.0) -> Sighting:
    """The place of an object whose outline is seen.

    Its middle lies on the middle line of sight, behind the nearest point by half of what an object of this size and
    heading (map frame; None: what its width in the image tells) is deep. What stands on wheels touches the road
    `inset_m` inside of its end.
    """
    rotation = view.map_from_camera[:3, :3]
    ends = (outline.points @ rotation.T)[:, :2]  # map directions, from the camera
    bearings = ends / np.linalg.norm(ends, axis=1, keepdims=True)
    sight_line = bearings[0] + bearings[2]
    sight_line /= np.linalg.norm(sight_line)
    across = np.array([-sight_line[1], sight_line[0]])
    near_m = float(max(ends[1] @ sight_line, 0.1))
    slopes = (bearings @ across) / (bearings @ sight_line)
    extent_m = float(abs(slopes[0] - slopes[2]) * near_m)
    turn = _turn_of(extent_m, size) if heading_rad is None else heading_rad - math.atan2(sight_line[1], sight_line[0])
    deep_m = size.length * abs(math.cos(turn)) + size.width * abs(math.sin(turn))
    range_m = near_m + deep_m / 2 - (0.0 if outline.by_depth else inset_m * abs(math.cos(turn)))
    center = np.append(view.map_from_camera[:2, 3] + range_m * sight_line, 0.0)
    center[2] = view.map_from_camera[2, 3] + float((rotation @ outline.points[1])[2])
    if outline.by_depth:
        along_m = 0.15 + 0.02 * near_m + 0.1 * deep_m
    else:
        along_m = _CONTACT_PX * near_m**2 / (view.focal_px * view.road_distance_m) + 0.03 * near_m + 0.1 * deep_m
    basis = np.column_stack((sight_line, across))
    covariance = basis @ np.diag([along_m**2, (_SIDE_M + 0.01 * near_m) ** 2]) @ basis.T
    return Sighting(center, covariance, _side_heading(ends, turn), extent_m, near_m)


def _turn_of(extent_m: float, size: Size) -> float:
    """Angle between heading and line of sight at which the object looks this wide, 0 to pi / 2."""
    turns = np.linspace(0.0, math.pi / 2, 46)
    widths = size.width * np.cos(turns) + size.length * np.sin(turns)
    return float(turns[np.argmin(np.abs(widths - extent_m))])


def _side_heading(ends: Array, turn: float) -> float | None:
    left, right = ends[0] - ends[1], ends[2] - ends[1]
    side = left if np.linalg.norm(left) > np.linalg.norm(right) else right
    if abs(math.sin(turn)) < math.sin(_END_ON):
        return None
    return math.atan2(side[1], side[0])
