# SPDX-License-Identifier: Apache-2.0
"""True optical flow from surfaces, poses and the motion of every triangle."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.pinhole import PinholeCamera
from services.simulator.frame import SimulatedFlow
from services.simulator.rendering.renderer import Hits

Floats = NDArray[np.float64]

_FAR_M = 1e7
_DEPTH_TOLERANCE, _INVERSE_TOLERANCE = 0.02, 2e-4
"""Differences of inverse depth, relative and in 1/m, below which two surfaces are taken for one."""


@dataclass(frozen=True, slots=True)
class View:
    """Surfaces seen from a pose (world_from_camera, 4x4)."""

    hits: Hits
    world_from_camera: Floats


def flow_between(
    camera: PinholeCamera, now: View, then: View, corners_now: Floats, corners_then: Floats
) -> SimulatedFlow:
    """Flow from one view to the next.

    The triangles that `now` hits have the corners (T, 3, 3), world frame, given for both times, so that the limbs of
    walking people move as they do.
    """
    columns, rows = camera.pixel_grid()
    x, y = camera.normalised(columns, rows)
    hits, world_from_camera = now.hits, now.world_from_camera
    sky = hits.triangle < 0
    depth = np.where(sky, _FAR_M, hits.depth_m.astype(np.float64))
    ray = np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float64)
    point = ray * depth[..., None] @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
    point = np.where(sky[..., None], point, _carried(point, hits.triangle, corners_now, corners_then))
    next_point = (point - then.world_from_camera[:3, 3]) @ then.world_from_camera[:3, :3]
    place = camera.project(next_point)
    flow = place - np.stack([columns, rows], axis=-1)
    visible = _seen_again(place, next_point[..., 2], then.hits)
    return SimulatedFlow(np.nan_to_num(flow, nan=0.0).astype(np.float32), visible)


def _carried(point: Floats, triangle: NDArray[np.int32], corners_now: Floats, corners_then: Floats) -> Floats:
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
