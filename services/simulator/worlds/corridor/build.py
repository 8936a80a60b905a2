# SPDX-License-Identifier: Apache-2.0
"""The corridor as a world."""

from __future__ import annotations

from services.simulator.options import DriveOptions
from services.simulator.painting.indoor.library import paint_indoor_library
from services.simulator.rendering.light import Light
from services.simulator.rendering.textures import TextureAtlas
from services.simulator.worlds.corridor.crowd import Crowd
from services.simulator.worlds.corridor.layout import corridor_mesh
from services.simulator.worlds.corridor.plan import FloorPlan
from services.simulator.worlds.corridor.robot import RobotPath
from services.simulator.worlds.world import World

LAMPS = Light(
    to_sun=(0.0, 0.0, 1.0),
    sun=(0.0, 0.0, 0.0),
    sky=(0.98, 1.0, 1.02),
    ground=(0.74, 0.78, 0.82),
    haze=(226.0, 226.0, 226.0),
    haze_length_m=400.0,
    contact_shade=0.4,
)
"""Rows of lamps under a bright ceiling: from above mostly, and much of it thrown back by the floor, also under feet."""


def build_corridor(options: DriveOptions) -> World:
    """An office floor.

    Raises:
        InputError: a speed or an offset that the corridor is too narrow for.
    """
    plan = FloorPlan(options.seed)
    robot = RobotPath(options, plan)
    atlas = TextureAtlas(paint_indoor_library(options.seed))
    actors = Crowd(options, plan, atlas.index).plan()
    return World(atlas, corridor_mesh(plan, options.seed, atlas.index), actors, robot, "wall_0", LAMPS)
