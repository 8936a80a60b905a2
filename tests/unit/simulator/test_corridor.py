# SPDX-License-Identifier: Apache-2.0
"""The corridor: a closed way that touches nothing, people who touch nobody, and the same bytes for the same seed."""

import numpy as np
import pytest

from services.runtime.errors import InputError
from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from services.simulator.worlds.corridor.build import build_corridor
from services.simulator.worlds.corridor.crowd import Crowd
from services.simulator.worlds.corridor.plan import HALF_WIDTH_M, FloorPlan
from services.simulator.worlds.corridor.robot import RobotPath

SEEDS = (1, 7, 8)
ROBOT_RADIUS_M = 0.25


class EveryName(dict[str, int]):
    """A texture table that has every name."""

    def __missing__(self, name: str) -> int:
        return 0


@pytest.mark.parametrize("seed", SEEDS)
def test_the_loop_closes_and_keeps_to_the_middle_of_the_corridor(seed: int) -> None:
    plan = FloorPlan(seed)
    line = plan.line
    assert 50.0 < line.length_m < 110.0
    np.testing.assert_allclose(line.point(line.length_m - 1e-6, 0.0), line.point(0.0, 0.0), atol=1e-4)
    assert abs(abs(line.heading(line.length_m) - line.heading(0.0)) - 2.0 * np.pi) < 1e-9
    s = np.linspace(0.0, line.length_m, 400)
    in_world = np.column_stack([line.point(s, 0.0), np.zeros(400), np.ones(400)])
    x, y = (in_world @ np.linalg.inv(plan.world_from_plan).T)[:, :2].T
    width, height = plan.size_m
    outside = np.hypot(np.maximum(np.maximum(-x, x - width), 0.0), np.maximum(np.maximum(-y, y - height), 0.0))
    np.testing.assert_allclose(outside, HALF_WIDTH_M, atol=0.01)


@pytest.mark.parametrize("seed", SEEDS)
def test_nobody_touches_anybody_nor_the_robot(seed: int) -> None:
    options = DriveOptions(world="corridor", seed=seed, traffic=1.0, frames=600, lateral_offset_m=0.25)
    plan = FloorPlan(seed)
    actors = Crowd(options, plan, EveryName()).plan()
    robot = RobotPath(options, plan)
    people = [actor for actor in actors if actor.category == "person"]
    assert len(people) > 20
    times = np.arange(0.0, 60.0, 0.25)
    at = np.stack([person.disc_centres(times)[:, 0] for person in people], axis=1)
    gap = np.linalg.norm(at[:, :, None] - at[:, None], axis=-1) + 10.0 * np.eye(len(people))
    assert gap.min() > 2.0 * 0.25
    camera = np.array([robot.world_from_camera(float(t))[:2, 3] for t in times])
    assert np.linalg.norm(at - camera[:, None], axis=-1).min() > 0.25 + ROBOT_RADIUS_M


@pytest.mark.parametrize("seed", SEEDS)
def test_who_walks_stays_between_the_walls(seed: int) -> None:
    plan = FloorPlan(seed)
    actors = Crowd(DriveOptions(world="corridor", seed=seed, traffic=1.0, frames=300), plan, EveryName()).plan()
    walkers = [actor for actor in actors if not actor.always_still]
    width, height = plan.size_m
    for walker in walkers:
        place = walker.disc_centres(np.arange(0.0, 30.0, 0.5))[:, 0]
        in_world = np.column_stack([place, np.zeros(len(place)), np.ones(len(place))])
        x, y = (in_world @ np.linalg.inv(plan.world_from_plan).T)[:, :2].T
        in_block = (x > -0.3) & (x < width + 0.3) & (y > -0.3) & (y < height + 0.3)
        assert not in_block.any()


def test_without_traffic_nothing_moves() -> None:
    actors = Crowd(DriveOptions(world="corridor", traffic=0.0), FloorPlan(7), EveryName()).plan()
    assert {"chair", "tv"} <= {actor.category for actor in actors}
    assert all(actor.always_still for actor in actors)


def test_other_traffic_leaves_the_furniture_where_it_is() -> None:
    def furniture(traffic_seed: int) -> list[tuple[int, str, list[float]]]:
        options = DriveOptions(world="corridor", traffic_seed=traffic_seed)
        actors = Crowd(options, FloorPlan(options.seed), EveryName()).plan()
        return [
            (actor.instance_id, actor.category, actor.at(0.0).centre_m.tolist())
            for actor in actors
            if actor.category != "person"
        ]

    assert furniture(1) == furniture(2)


def test_a_longer_drive_begins_as_a_shorter_one() -> None:
    short, long = (build_corridor(DriveOptions(world="corridor", frames=frames)) for frames in (50, 300))
    assert len(short.actors) == len(long.actors)
    for one, other in zip(short.actors, long.actors, strict=True):
        np.testing.assert_array_equal(one.at(4.0).world_from_object, other.at(4.0).world_from_object)


def test_the_walls_close_the_view_and_seeds_differ() -> None:
    frames = [Drive(DriveOptions(world="corridor", seed=seed, width=96, height=64)).render(30) for seed in (7, 7, 8)]
    assert all((frame.depth_m > 0.0).all() for frame in frames)
    assert all(frame.depth_m.max() < 40.0 for frame in frames)
    np.testing.assert_array_equal(frames[0].image, frames[1].image)
    assert (frames[0].image != frames[2].image).mean() > 0.5


@pytest.mark.parametrize(("name", "value"), [("speed_m_s", 8.0), ("lateral_offset_m", 1.0)])
def test_what_is_too_much_for_a_corridor_is_refused(name: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"{name}={value}: expected .* in a corridor"):
        RobotPath(DriveOptions(world="corridor", **{name: value}), FloorPlan(7))  # type: ignore[arg-type]
