# SPDX-License-Identifier: Apache-2.0
"""The town as a world."""

from __future__ import annotations

from services.simulator.options import DriveOptions
from services.simulator.painting.town_library import paint_town_library
from services.simulator.rendering.textures import TextureAtlas
from services.simulator.worlds.town.layout.town import town_mesh
from services.simulator.worlds.town.survey import survey_town
from services.simulator.worlds.town.traffic.planner import plan_traffic
from services.simulator.worlds.world import World


def build_town(options: DriveOptions) -> World:
    """A closed loop of streets through several blocks, and who is about in it.

    What stands follows from `seed`, `loop_m` and `max_slope` alone.
    """
    survey = survey_town(options)
    atlas = TextureAtlas(paint_town_library(options.seed))
    mesh = town_mesh(survey, options.seed, options.max_slope, atlas.index)
    actors, camera_path = plan_traffic(options, survey.plan, atlas.index)
    return World(atlas, mesh, actors, camera_path)
