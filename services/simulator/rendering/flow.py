# SPDX-License-Identifier: Apache-2.0
"""True optical flow from surfaces, poses and the motion of every triangle."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.camera import Camera
from services.simulator.frame import SimulatedFlow
from services.simulator.rendering.bands import Bands
from services.simulator.rendering.nearest import Hits

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

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


class FlowTruth:
    """Flow of one camera's views."""

    def __init__(self, camera: Camera, bands: Bands) -> None:
        self._camera, self._bands = camera, bands
        self._pixel = np.stack(camera.pixel_grid(), axis=-1)
        x, y = camera.normalised()
        self._ray = np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float64)

    def between(self, now: Hits, pose: Floats, moved: MovedTriangles, then: View) -> SimulatedFlow:
        """Flow from one view to the next, of `moved` triangles as they move, so that limbs of walking people do too.

        now: seen from pose (world_from_camera, 4x4). Where nobody looked then, everything counts as visible.
        """
        flow = np.empty((*now.triangle.shape, 2), np.float32)
        visible = np.ones(now.triangle.shape, bool)
        motion, row_of = _motion_of_seen(now.triangle, moved)
        next_pose = then.world_from_camera
        nearness = None if then.hits is None else 1.0 / then.hits.depth_m

        def carry(band: slice) -> None:
            triangle = now.triangle[band]
            depth = np.where(triangle < 0, _FAR_M, now.depth_m[band].astype(np.float64))
            point = self._ray[band] * depth[..., None] @ pose[:3, :3].T + pose[:3, 3]
            which = np.nonzero(triangle >= moved.first)
            each = motion[row_of[triangle[which] - moved.first]]
            point[which] = (each[:, :, :3] @ point[which][..., None])[..., 0] + each[:, :, 3]
            next_point = (point - next_pose[:3, 3]) @ next_pose[:3, :3]
            place = self._camera.project(next_point)
            flow[band] = np.nan_to_num(place - self._pixel[band], nan=0.0)
            if nearness is not None:
                visible[band] = _seen_again(place, next_point[..., 2], nearness)

        self._bands.run(carry, *now.triangle.shape)
        return SimulatedFlow(flow, visible)


def _motion_of_seen(triangle: NDArray[np.int32], moved: MovedTriangles) -> tuple[Floats, NDArray[np.int32]]:
    """How each triangle seen moves, later_from_now (N, 3, 4), and each moved triangle's row among them.

    A point keeps its place within its triangle's own axes.
    """
    seen = np.zeros(len(moved.before), bool)
    seen[triangle[triangle >= moved.first] - moved.first] = True
    rows = np.flatnonzero(seen)
    row_of = np.cumsum(seen, dtype=np.int32) - 1
    before, after = moved.before[rows], moved.after[rows]
    rotation = _axes(after) @ np.linalg.inv(_axes(before))
    shift = after[:, 0] - (rotation @ before[:, 0, :, None])[..., 0]
    return np.concatenate([rotation, shift[..., None]], axis=2), row_of


def _axes(corner: Floats) -> Floats:
    """Both edges and the unit normal of triangles as columns, (N, 3, 3)."""
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(e1, e2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([e1, e2, normal], axis=-1)


def _seen_again(place: Floats, depth_m: Floats, nearness: Floats32) -> NDArray[np.bool_]:
    """Whether the next view, of inverse depth `nearness`, shows a surface of the depth expected at `place`.

    Inverse depth is linear in the image over a plane, so that the ground is found again however slanted it is seen,
    while a pixel half covered by something nearer is not.
    """
    height, width = nearness.shape
    inside = np.all((place >= 0.0) & (place <= [width - 1.0, height - 1.0]), axis=-1)
    at = np.where(inside[..., None], np.nan_to_num(place), 0.0).astype(np.float32)
    seen = cv2.remap(nearness, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
    expected = 1.0 / np.maximum(depth_m, 1e-3)
    return np.asarray(inside & (np.abs(seen - expected) < _DEPTH_TOLERANCE * expected + _INVERSE_TOLERANCE))
