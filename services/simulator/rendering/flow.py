# SPDX-License-Identifier: Apache-2.0
"""True optical flow from surfaces, poses and the motion of every triangle."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.camera import Camera
from services.simulator.frame import SimulatedFlow
from services.simulator.rendering.nearest import Hits

Floats = NDArray[np.float64]

_FAR_M = 1e7
_DEPTH_TOLERANCE, _INVERSE_TOLERANCE = 0.02, 2e-4
"""Differences of inverse depth, relative and in 1/m, below which two surfaces are taken for one."""


@dataclass(frozen=True, slots=True)
class MovedTriangles:
    """Corners (T, 3, 3), world frame, of triangles at two times; the first one is row `first` of the scene's."""

    first: int
    before: Floats
    after: Floats


@dataclass(frozen=True, slots=True)
class View:
    """Surfaces seen from a pose (world_from_camera, 4x4); None where nobody looked."""

    world_from_camera: Floats
    hits: Hits | None


def flow_between(camera: Camera, now: Hits, pose: Floats, moved: MovedTriangles, then: View) -> SimulatedFlow:
    """Flow from one view to the next, of `moved` triangles as they move, so that limbs of walking people do too.

    now: seen from pose (world_from_camera, 4x4). Where nobody looked then, everything counts as visible.
    """
    next_pose = then.world_from_camera
    columns, rows = camera.pixel_grid()
    x, y = camera.normalised()
    sky = now.triangle < 0
    depth = np.where(sky, _FAR_M, now.depth_m.astype(np.float64))
    ray = np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float64)
    point = ray * depth[..., None] @ pose[:3, :3].T + pose[:3, 3]
    _carry(point, now.triangle, moved)
    next_point = (point - next_pose[:3, 3]) @ next_pose[:3, :3]
    place = camera.project(next_point)
    flow = np.nan_to_num(place - np.stack([columns, rows], axis=-1), nan=0.0).astype(np.float32)
    visible = np.ones(sky.shape, bool) if then.hits is None else _seen_again(place, next_point[..., 2], then.hits)
    return SimulatedFlow(flow, visible)


def _carry(point: Floats, triangle: NDArray[np.int32], moved: MovedTriangles) -> None:
    """Move points (H, W, 3) with their triangles: by position within a triangle's axes, put back at the later time."""
    which = np.nonzero(triangle >= moved.first)
    rows = triangle[which] - moved.first
    here = np.flatnonzero(np.any(moved.before[rows] != moved.after[rows], axis=(1, 2)))
    which, rows = tuple(axis[here] for axis in which), rows[here]
    before, after = moved.before[rows], moved.after[rows]
    relative = np.linalg.solve(_axes(before), (point[which] - before[:, 0])[..., None])
    point[which] = after[:, 0] + (_axes(after) @ relative)[..., 0]


def _axes(corner: Floats) -> Floats:
    """Both edges and the unit normal of triangles as columns, (N, 3, 3)."""
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(e1, e2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([e1, e2, normal], axis=-1)


def _seen_again(place: Floats, depth_m: Floats, then: Hits) -> NDArray[np.bool_]:
    """Whether the next view shows a surface of the depth expected at `place`, between pixel centres.

    Inverse depth is linear in the image over a plane, so that the ground is found again however slanted it is seen,
    while a pixel half covered by something nearer is not.
    """
    height, width = then.depth_m.shape
    inside = np.all((place >= 0.0) & (place <= [width - 1.0, height - 1.0]), axis=-1)
    at = np.where(inside[..., None], np.nan_to_num(place), 0.0).astype(np.float32)
    seen = cv2.remap(1.0 / then.depth_m, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
    expected = 1.0 / np.maximum(depth_m, 1e-3)
    return np.asarray(inside & (np.abs(seen - expected) < _DEPTH_TOLERANCE * expected + _INVERSE_TOLERANCE))
