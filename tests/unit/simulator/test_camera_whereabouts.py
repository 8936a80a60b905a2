# SPDX-License-Identifier: Apache-2.0
"""Nobody in sight is overlooked for being asked only roughly."""

import numpy as np

from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from services.simulator.rendering.whereabouts import Reach, Whereabouts
from tests.unit.simulator.traffic_scene import planned


def test_everybody_in_range_is_found_and_many_others_are_not() -> None:
    everybody, camera = planned(DriveOptions(world="town", seed=2, traffic=0.5, max_slope=0.1))
    actors = [actor for actor in everybody if not actor.always_still]
    whereabouts = Whereabouts(actors)
    asked = 0
    reach = Reach(range_m=80.0, slope=0.84, around_m=15.0)
    for t_s in (0.0, 3.3, 12.49, 12.51, 63.6, 64.0, 5.0):
        pose = camera.world_from_camera(t_s)
        found = set(whereabouts.perhaps_in_sight(pose, t_s, reach).tolist())
        for number, actor in enumerate(actors):
            state = actor.at(t_s)
            away = state.centre_m[:2] - pose[:2, 3]
            distance, ahead, beside = np.hypot(*away), away @ pose[:2, 2], abs(away @ pose[:2, 0])
            seen = distance < 80.0 and ahead > 0.0 and beside < 0.84 * ahead
            if state.present and (seen or distance < 15.0):
                assert number in found
        asked += len(found)
    assert 0 < asked < 0.6 * 7 * len(actors)


def test_who_is_out_of_sight_is_not_built_and_who_is_in_sight_is(street: Drive) -> None:
    """The moving surfaces of a moment are few, and a drive that builds all of them (for shadows) sees the same."""
    everybody = Drive(DriveOptions(shadows=True))
    for index in (110, 190, 240):
        assert np.array_equal(street.render(index).labels, everybody.render(index).labels)
        assert np.array_equal(street.render(index).depth_m, everybody.render(index).depth_m)
