# SPDX-License-Identifier: Apache-2.0
"""Things of a world that can move, as pure functions of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.actors.placement import axle_pose, planar_pose
from services.simulator.shapes.meshes import Mesh
from services.simulator.shapes.people import Gait

Floats = NDArray[np.float64]

MOVING_M_S = 0.1
"""An actor moves from this speed on."""
_HALF_STEP_M = 0.15
_TANGENT_M = 0.02


@dataclass(frozen=True, slots=True)
class ActorState:
    """An actor at one time, in the world frame.

    world_from_object: 4x4, on the ground. centre_m: (3,), middle of the cuboid. velocity_m_s: (3,), of the object's
    origin; who walks has none upwards, for climbing kerbs is not counted. heading_rad: of its x axis on the plane,
    against world x. walked_m: way gone. present: whether the world reaches to where it is.
    """

    world_from_object: Floats
    centre_m: Floats
    heading_rad: float
    velocity_m_s: Floats
    moving: bool
    walked_m: float
    present: bool


@dataclass(frozen=True, slots=True)
class Actor:
    """A car or a person with an identity that lasts over the drive.

    mesh: in the object frame (x forward, y left, z up, origin on the ground). size_m: length, width, height.
    disc_radius_m, disc_offsets_m: the discs along x that stand for the actor when collisions are looked for.
    half_base_m: half the distance of its axles, which both stand on the path, so that it pitches with the slope and
    cuts corners as it would; 0: upright, its origin on the path.
    """

    instance_id: int
    category: str
    mesh: Mesh
    size_m: tuple[float, float, float]
    path: Path
    speed: SpeedProfile
    gait: Gait | None
    disc_radius_m: float
    disc_offsets_m: tuple[float, ...]
    half_base_m: float = 0.0

    @property
    def always_still(self) -> bool:
        """Whether it never moves during the drive."""
        return self.speed.always_still

    def at(self, t_s: float) -> ActorState:
        """Where it is and how it moves at a time (moving: at 0.1 m/s or more)."""
        gone = float(self.speed.distance_m(t_s))
        speed = float(self.speed.speed_m_s(t_s))
        if self.half_base_m > 0.0:
            return self._on_axles(gone, speed)
        behind, position, ahead = self.path.point(gone + np.array([-_HALF_STEP_M, 0.0, _HALF_STEP_M]))
        step = ahead - behind
        step[2] = 0.0
        heading = float(np.arctan2(step[1], step[0]))
        pose = planar_pose(position[:2], heading)
        pose[2, 3] = position[2]
        centre = position + np.array([0.0, 0.0, 0.5 * self.size_m[2]])
        velocity = step * (speed / (2.0 * _HALF_STEP_M))
        moving = float(np.linalg.norm(velocity)) >= MOVING_M_S
        return ActorState(pose, centre, heading, velocity, moving, gone, bool(self.path.inside(gone)))

    def _on_axles(self, gone: float, speed: float) -> ActorState:
        base, near = self.half_base_m, _TANGENT_M
        around = np.array([-_HALF_STEP_M, -near, near, _HALF_STEP_M])
        point = self.path.point(gone + np.concatenate([around - base, around + base]))
        pose = axle_pose(0.5 * (point[1] + point[2]), 0.5 * (point[5] + point[6]))
        # Over more of the way than the pose: paths of junctions join to within centimetres only.
        velocity = (point[3] - point[0] + point[7] - point[4]) * (speed / (4.0 * _HALF_STEP_M))
        centre = pose[:3, 3] + 0.5 * self.size_m[2] * pose[:3, 2]
        heading = float(np.arctan2(pose[1, 0], pose[0, 0]))
        moving = float(np.linalg.norm(velocity)) >= MOVING_M_S
        return ActorState(pose, centre, heading, velocity, moving, gone, bool(self.path.inside(gone)))

    def vertices_in_world(self, state: ActorState) -> Floats:
        """Its mesh's vertices, (V, 3), in a state of its own."""
        vertices = self.mesh.vertices
        if self.gait is not None and not self.always_still:
            vertices = self.gait.swung(vertices, state.walked_m)
        pose = state.world_from_object
        return vertices @ pose[:3, :3].T + pose[:3, 3]

    def disc_centres(self, t_s: Floats) -> Floats:
        """World (x, y) of its discs at several times, (T, discs, 2); NaN where it is not present."""
        gone = self.speed.distance_m(t_s)
        step = self.path.point(gone + _HALF_STEP_M) - self.path.point(gone - _HALF_STEP_M)
        ahead = step[:, None, :2] / np.hypot(step[:, 0], step[:, 1])[:, None, None]
        discs = self.path.point(gone)[:, None, :2] + np.array(self.disc_offsets_m)[None, :, None] * ahead
        return np.where(self.path.inside(gone)[:, None, None], discs, np.nan)
