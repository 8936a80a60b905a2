# SPDX-License-Identifier: Apache-2.0
"""What every world gives to be driven through."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor
from services.simulator.rendering.light import Light
from services.simulator.rendering.textures import TextureAtlas
from services.simulator.shapes.meshes import Mesh


class CameraPath(Protocol):
    """How the camera goes through a world."""

    def world_from_camera(self, t_s: float) -> NDArray[np.float64]:
        """Pose at a time, 4x4; camera optical, world x forward and y left at the start, z up, metres."""
        ...


@dataclass(frozen=True, slots=True)
class World:
    """A world frame full of things.

    mesh: everything that can never move. actors: everybody who could, those who stand all the time included; their ids
    count from 1. atlas: the textures of both. sky_texture: the one that is seen where there is no surface.
    light: the world's own, whatever light the options ask for; None under the open sky.
    """

    atlas: TextureAtlas
    mesh: Mesh
    actors: list[Actor]
    camera_path: CameraPath
    sky_texture: str = "clouds"
    light: Light | None = None
