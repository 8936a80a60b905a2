# SPDX-License-Identifier: Apache-2.0
"""Things of the street that can move, as pure functions of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.meshes import Mesh
from services.simulator.motion import Path, SpeedProfile
from services.simulator.people import Gait
from services.simulator.road import planar_pose

Floats = NDArray[np.float64]

MOVING_M_S = 0.1
"""An actor moves from this speed on."""
_HALF_STEP_M = 0.15


@dataclass(frozen=True, slots=True)
class Actor:
    """A car or a person with an identity that lasts over the drive.

    mesh: in the object frame (x forward, y left, z up, origin on the ground). size_m: length, width, height.
    disc_radius_m, disc_offsets_m: the discs along x that stand for the actor when collisions are looked for.
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

    @property
    def always_still(self) -> bool:
        """Whether it never moves during the drive."""
        return self.speed.always_still

    def present(self, t_s: Floats | float) -> NDArray[np.bool_]:
        """Whether the street reaches to where it is."""
        return self.path.inside(self.speed.distance_m(t_s))

    def heading_rad(self, t_s: Floats | float) -> Floats:
        """Direction it faces against world x."""
        gone = self.speed.distance_m(t_s)
        step = self.path.point(gone + _HALF_STEP_M) - self.path.point(gone - _HALF_STEP_M)
        return np.arctan2(step[..., 1], step[..., 0])

    def world_from_object(self, t_s: float) -> Floats:
        """Pose at a time, 4x4."""
        position = self.path.point(self.speed.distance_m(t_s))
        pose = planar_pose(position[:2], float(self.heading_rad(t_s)))
        pose[2, 3] = position[2]
        return pose

    def velocity_m_s(self, t_s: float) -> Floats:
        """Velocity of its origin in the world frame, (3,): the profile's speed along the path; climbing kerbs is not
        counted."""
        gone = float(self.speed.distance_m(t_s))
        step = self.path.point(gone + 1e-3) - self.path.point(gone - 1e-3)
        step[2] = 0.0
        return step / np.linalg.norm(step) * float(self.speed.speed_m_s(t_s))

    def moving(self, t_s: float) -> bool:
        """Whether it moves at 0.1 m/s or more."""
        return float(self.speed.speed_m_s(t_s)) >= MOVING_M_S

    def centre_m(self, t_s: float) -> Floats:
        """Middle of its cuboid in the world frame, (3,)."""
        centre = self.path.point(self.speed.distance_m(t_s)).copy()
        centre[2] += 0.5 * self.size_m[2]
        return centre

    def vertices_in_world(self, t_s: float) -> Floats:
        """Its mesh's vertices at a time, (V, 3)."""
        vertices = self.mesh.vertices
        if self.gait is not None and not self.always_still:
            vertices = self.gait.swung(vertices, float(self.speed.distance_m(t_s)))
        pose = self.world_from_object(t_s)
        return vertices @ pose[:3, :3].T + pose[:3, 3]

    def disc_centres(self, t_s: Floats) -> Floats:
        """World (x, y) of its discs at several times, (T, discs, 2); far away where it is not present."""
        position = self.path.point(self.speed.distance_m(t_s))[:, None, :2]
        heading = self.heading_rad(t_s)
        ahead = np.stack([np.cos(heading), np.sin(heading)], axis=-1)[:, None, :]
        discs = position + np.array(self.disc_offsets_m)[None, :, None] * ahead
        return np.where(self.present(t_s)[:, None, None], discs, 1e6)
