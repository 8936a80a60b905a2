# SPDX-License-Identifier: Apache-2.0
"""The street as a world."""

from __future__ import annotations

from services.simulator.options import DriveOptions
from services.simulator.painting.library import paint_library
from services.simulator.rendering.textures import TextureAtlas
from services.simulator.worlds.street.ego import EgoTrajectory
from services.simulator.worlds.street.layout import street_mesh
from services.simulator.worlds.street.road import Road
from services.simulator.worlds.street.traffic import TrafficPlanner
from services.simulator.worlds.world import World


def build_street(options: DriveOptions) -> World:
    """A winding street with houses on both sides.

    Raises:
        InputError: more actors of one kind than the street has room for.
    """
    road = Road(options.drive_length_m, options.seed)
    ego = EgoTrajectory(options, road)
    atlas = TextureAtlas(paint_library(options.seed))
    actors = TrafficPlanner(options, road, ego, atlas.index).plan()
    return World(atlas, street_mesh(road, options.seed, atlas.index), actors, ego)
