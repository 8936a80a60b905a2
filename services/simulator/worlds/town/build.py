# SPDX-License-Identifier: Apache-2.0
"""The town as a world."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.options import DriveOptions
from services.simulator.painting.town_library import paint_town_library
from services.simulator.rendering.textures import TextureAtlas
from services.simulator.worlds.town.layout.town import town_mesh
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import LANE_CENTRES_M
from services.simulator.worlds.town.survey import survey_town
from services.simulator.worlds.world import World

Floats = NDArray[np.float64]


class _InnerLane:
    """Along the right inner lane at constant speed."""

    def __init__(self, options: DriveOptions, plan: TownPlan) -> None:
        self._options, self._plan = options, plan

    def _at(self, s: float) -> Floats:
        xy = self._plan.loop.point(s, self._options.lateral_offset_m - LANE_CENTRES_M[0])
        return np.append(xy, self._plan.ground.height_m(xy) + self._options.camera_height_m)

    def world_from_camera(self, t_s: float) -> Floats:
        """Pose at a time, 4x4."""
        s = self._options.start_m + self._options.speed_m_s * t_s
        ahead = self._at(s + 0.5) - self._at(s - 0.5)
        ahead /= np.linalg.norm(ahead)
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([right, np.cross(ahead, right), ahead], axis=1)
        pose[:3, 3] = self._at(s)
        return pose


def build_town(options: DriveOptions) -> World:
    """A closed loop of streets through several blocks."""
    survey = survey_town(options)
    atlas = TextureAtlas(paint_town_library(options.seed))
    mesh = town_mesh(survey, options.seed, options.max_slope, atlas.index)
    return World(atlas, mesh, [], _InnerLane(options, survey.plan))
