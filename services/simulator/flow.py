# SPDX-License-Identifier: Apache-2.0
"""True optical flow from surfaces, poses and the motion of every triangle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera import PinholeCamera
from services.simulator.frame import SimulatedFlow
from services.simulator.renderer import Hits

Floats = NDArray[np.float64]

_FAR_M = 1e7
_DEPTH_TOLERANCE = 0.02
"""Relative difference of depth below which two surfaces are taken for one."""


def flow_between(
    camera: PinholeCamera, now: Hits, then: Hits, world_from_camera: Floats, next_world_from_camera: Floats,
    corners_now: Floats, corners_then: Floats,
) -> SimulatedFlow:
    """Flow from one view to the next.

    now, then: surfaces of both views; the triangles of `now` have the corners (T, 3, 3), in the world frame, given for
    both times, so that limbs of walking people move as they do.
    """
    columns, rows = camera.pixel_grid()
    x, y = camera.normalised(columns, rows)
    sky = now.triangle < 0
    depth = np.where(sky, _FAR_M, now.depth_m.astype(np.float64))
    ray = np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float64)
    point = ray * depth[..., None] @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
    point = np.where(sky[..., None], point, _carried(point, now.triangle, corners_now, corners_then))
    rotation, origin = next_world_from_camera[:3, :3], next_world_from_camera[:3, 3]
    next_point = (point - origin) @ rotation
    place = camera.project(next_point)
    flow = place - np.stack([columns, rows], axis=-1)
    visible = _seen_again(place, next_point[..., 2], then)
    return SimulatedFlow(np.nan_to_num(flow, nan=0.0).astype(np.float32), visible)


def _carried(
    point: Floats, triangle: NDArray[np.int32], corners_now: Floats, corners_then: Floats
) -> Floats:
    """Points moved with their triangles: position within the triangle's own axes, put back at the later time."""
    moved = np.any(corners_now != corners_then, axis=(1, 2))
    which = np.nonzero((triangle >= 0) & moved[triangle])
    rows = triangle[which]
    before, after = corners_now[rows], corners_then[rows]
    relative = np.linalg.solve(_axes(before), (point[which] - before[:, 0])[..., None])
    result = point.copy()
    result[which] = after[:, 0] + (_axes(after) @ relative)[..., 0]
    return result


def _axes(corner: Floats) -> Floats:
    """Both edges and the unit normal of triangles as columns, (N, 3, 3)."""
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(e1, e2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([e1, e2, normal], axis=-1)


def _seen_again(place: Floats, depth_m: Floats, then: Hits) -> NDArray[np.bool_]:
    """Whether the four pixels around `place` in the next view show a surface at the depth expected."""
    height, width = then.depth_m.shape
    inside = np.all((place >= 0.0) & (place <= [width - 1.0, height - 1.0]), axis=-1)
    corner = np.where(inside[..., None], np.floor(np.nan_to_num(place)), 0.0).astype(np.intp)
    seen = then.depth_m.astype(np.float64)
    agrees = inside
    for dx in (0, 1):
        for dy in (0, 1):
            column = np.minimum(corner[..., 0] + dx, width - 1)
            row = np.minimum(corner[..., 1] + dy, height - 1)
            found = np.where(np.isfinite(seen[row, column]), seen[row, column], _FAR_M)
            both_far = (found >= _FAR_M) & (depth_m >= 0.9 * _FAR_M)
            agrees = agrees & (both_far | (np.abs(found - depth_m) < _DEPTH_TOLERANCE * depth_m + 0.05))
    return agrees
