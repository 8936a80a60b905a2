# SPDX-License-Identifier: Apache-2.0
"""What is said of the town's actors is true: speeds, slopes, feet on the ground; and nobody looks ahead in time."""

from collections import defaultdict

import numpy as np
import pytest

from services.simulator.actors.actor import Actor
from services.simulator.actors.motion import SpeedProfile
from services.simulator.options import DriveOptions
from services.simulator.shapes.vehicles.styles import SALOON
from services.simulator.worlds.town.paths import ChainPath, StraightPath
from services.simulator.worlds.town.traffic.looks import Wardrobe
from tests.unit.simulator.traffic_scene import planned, town

OPTIONS = DriveOptions(world="town", seed=2, traffic=0.5, max_slope=0.1)
TIMES_S = (0.37, 8.23, 19.91, 27.44)


class Slope:
    """A plane that rises along x."""

    def height_m(self, xy: np.ndarray) -> np.ndarray:
        return 0.08 * xy[..., 0]


def test_velocity_is_the_derivative_of_position() -> None:
    actors, _ = planned(OPTIONS)
    step_s, moved, climbed = 1e-4, 0, 0.0
    for t_s in TIMES_S:
        for actor in actors:
            before, now, after = (actor.at(t_s + k * step_s) for k in (-1, 0, 1))
            if not (before.present and after.present):
                continue
            origin = (after.world_from_object - before.world_from_object)[:3, 3] / (2.0 * step_s)
            level = actor.category == "person" and actor.half_base_m == 0.0
            axes = 2 if level else 3
            # Somebody who turns round on the spot has a heading that is smoothed over a step.
            allowed = 0.35 if level else 0.03
            assert origin[:axes] == pytest.approx(now.velocity_m_s[:axes], abs=allowed)
            assert now.moving == (np.linalg.norm(now.velocity_m_s) >= 0.1)
            moved += int(now.moving)
            climbed = max(climbed, abs(float(now.velocity_m_s[2])))
    assert moved > 150
    assert climbed > 0.2


def test_a_step_between_two_paths_does_not_show_as_speed() -> None:
    """Ways of junctions join to within centimetres."""
    looks = Wardrobe(defaultdict(int)).vehicle(SALOON, 1)
    parts = [StraightPath(np.array([x_m, 0.0]), 0.0, Slope()) for x_m in (0.0, 10.03)]
    actor = Actor(1, path=ChainPath(parts, [0.0, 10.0], np.inf), speed=SpeedProfile([(0.0, 8.0)]), **looks)
    speeds = [np.linalg.norm(actor.at(gone_m / 8.0).velocity_m_s[:2]) for gone_m in np.arange(7.0, 13.0, 0.01)]
    assert speeds == pytest.approx([8.0] * len(speeds), rel=0.06)


def test_wheels_stand_on_the_ground_and_cars_pitch_with_the_slope() -> None:
    actors, _ = planned(OPTIONS)
    ground = town(OPTIONS.seed).ground
    pitches = []
    for actor in actors:
        state = actor.at(5.0)
        pose = state.world_from_object
        assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-9)
        if actor.half_base_m and state.present:
            for end in (-1.0, 1.0):
                wheel = pose[:3, 3] + end * actor.half_base_m * pose[:3, 0]
                assert wheel[2] == pytest.approx(float(ground.height_m(wheel[:2])), abs=0.03)
            assert state.centre_m == pytest.approx(pose[:3, 3] + 0.5 * actor.size_m[2] * pose[:3, 2])
            pitches.append(float(pose[2, 0]))
        elif state.present:
            assert pose[:3, 2] == pytest.approx([0.0, 0.0, 1.0])
            assert pose[2, 3] == pytest.approx(float(ground.height_m(pose[:2, 3])), abs=1e-9)
    assert max(np.abs(pitches)) > 0.02


def test_a_car_on_a_plane_slope_has_exactly_its_pitch() -> None:
    looks = Wardrobe(defaultdict(int)).vehicle(SALOON, 1)
    speed = SpeedProfile([(0.0, 5.0), (1.0, 5.0)])
    actor = Actor(1, path=StraightPath(np.zeros(2), 0.0, Slope()), speed=speed, **looks)
    state = actor.at(2.0)
    assert state.world_from_object[2, 0] == pytest.approx(np.sin(np.arctan(0.08)))
    assert state.velocity_m_s == pytest.approx([5.0, 0.0, 0.4])
    assert state.world_from_object[:3, 3] == pytest.approx([10.0, 0.0, 0.8])


def test_a_longer_drive_begins_as_the_shorter_one() -> None:
    short, short_camera = planned(DriveOptions(world="town", seed=4, traffic=0.7, frames=80))
    long, long_camera = planned(DriveOptions(world="town", seed=4, traffic=0.7, frames=300))
    by_id = {actor.instance_id: actor for actor in long}
    ids = [actor.instance_id for actor in short]
    assert ids == sorted(set(ids))
    assert ids[0] == 1
    for t_s in np.arange(0.0, 8.0, 0.7):
        assert np.array_equal(short_camera.world_from_camera(t_s), long_camera.world_from_camera(t_s))
    for actor in short:
        other = by_id[actor.instance_id]
        assert np.array_equal(actor.mesh.vertices, other.mesh.vertices)
        assert actor.always_still == other.always_still
        for t_s in (0.0, 3.3, 7.9):
            mine, its = actor.at(t_s), other.at(t_s)
            assert mine.present == its.present
            assert np.array_equal(mine.world_from_object, its.world_from_object)
            assert np.array_equal(mine.velocity_m_s, its.velocity_m_s)
    late = {actor.instance_id for actor in long} - {actor.instance_id for actor in short}
    assert not any(by_id[number].at(7.9).present for number in late)


def test_the_traffic_seed_changes_who_moves_and_nothing_else_does() -> None:
    one, _ = planned(DriveOptions(world="town", seed=2, traffic=0.3, traffic_seed=5))
    again, _ = planned(DriveOptions(world="town", seed=2, traffic=0.3, traffic_seed=5, width=320))
    other, _ = planned(DriveOptions(world="town", seed=2, traffic=0.3, traffic_seed=6))

    def where(actors: list[Actor]) -> list[list[float]]:
        return [actor.at(4.0).centre_m.tolist() for actor in actors]

    assert where(one) == where(again)
    assert where(one) != where(other)


def test_parked_cars_never_move_and_some_stand_crooked() -> None:
    actors, _ = planned(OPTIONS)
    parked = [a for a in actors if a.always_still and a.category == "car"]
    loop = town(OPTIONS.seed).loop
    s = np.arange(0.0, loop.length_m, 0.5)
    line, heading = loop.point(s, 0.0), loop.heading(s)
    crooked = []
    for actor in parked:
        state = actor.at(0.0)
        assert np.array_equal(state.world_from_object, actor.at(30.0).world_from_object)
        assert not state.moving
        along = heading[np.argmin(np.hypot(*(line - state.centre_m[:2]).T))]
        crooked.append(abs((state.heading_rad - along + 0.5 * np.pi) % np.pi - 0.5 * np.pi) > 0.015)
    assert len(parked) > 25
    assert 0.15 < np.mean(crooked) < 0.55
    assert len({actor.size_m for actor in parked}) >= 5
