# SPDX-License-Identifier: Apache-2.0
"""The town before anything stands in it: a closed, driveable loop, junctions beside it, hills as steep as asked."""

from functools import lru_cache

import numpy as np
import pytest

from services.simulator.options import DriveOptions
from services.simulator.worlds.line import SampledLine, line_through
from services.simulator.worlds.town.loop import MIN_RADIUS_M, town_loop
from services.simulator.worlds.town.profile import (
    CROSSING_CLEAR_M,
    KERB_M,
    LANE_CENTRES_M,
    SIDE_STOP_M,
)
from services.simulator.worlds.town.survey import TownSurvey, survey_town

SEEDS = range(24)


@lru_cache(maxsize=64)
def survey(seed: int, **wanted: float) -> TownSurvey:
    return survey_town(DriveOptions(world="town", seed=seed, **wanted))  # type: ignore[arg-type]


def around(ds: np.ndarray | float, length_m: float) -> np.ndarray:
    return np.abs((np.asarray(ds) + 0.5 * length_m) % length_m - 0.5 * length_m)


@pytest.mark.parametrize("loop_m", [500.0, 640.0, 1234.5, 3000.0])
def test_loop_closes_and_is_as_long_as_asked(loop_m: float) -> None:
    for seed in SEEDS:
        line = town_loop(seed, loop_m).line
        assert line.length_m == pytest.approx(loop_m)
        before, after = line.point(np.array([loop_m - 1e-6, loop_m + 1e-6]), 0.0)
        assert np.linalg.norm(after - before) < 1e-4
        assert abs(line.heading(loop_m) - line.heading(0.0)) == pytest.approx(2.0 * np.pi, abs=1e-9)
        s = np.arange(0.0, loop_m, 0.5)
        assert np.linalg.norm(np.diff(line.point(s, 0.0), axis=0), axis=1).sum() == pytest.approx(loop_m - 0.5, abs=0.1)


def test_every_curve_can_be_driven_in_the_inner_lane() -> None:
    for loop_m in (500.0, 700.0, 1600.0):
        for seed in SEEDS:
            line = town_loop(seed, loop_m).line
            assert np.abs(line.curvature(np.arange(0.0, loop_m, 0.2))).max() <= 1.0 / MIN_RADIUS_M


def test_loop_keeps_clear_of_itself() -> None:
    for loop_m in (500.0, 900.0, 2400.0):
        for seed in SEEDS:
            line = town_loop(seed, loop_m).line
            s = np.arange(0.0, loop_m, 4.0)
            points = line.point(s, 0.0)
            apart = around(s[:, None] - s[None, :], loop_m) > 90.0
            gaps = np.linalg.norm(points[:, None] - points[None, :], axis=-1)
            assert gaps[apart].min() > 2.0 * KERB_M + 20.0


def test_towns_turn_both_ways_and_differ_in_shape() -> None:
    loops = [town_loop(seed, 900.0) for seed in SEEDS]
    assert len({len(loop.streets) for loop in loops}) >= 3
    assert {np.sign(loop.line.heading(900.0)) for loop in loops} == {-1.0, 1.0}
    turns = [{np.sign(street.turn_rad) for street in loop.streets} for loop in loops]
    assert sum(len(both) == 2 for both in turns) >= len(loops) // 3
    assert sum(any(street.bent for street in loop.streets) for loop in loops) > len(loops) // 2


def test_camera_starts_at_the_origin_on_a_straight_piece() -> None:
    for seed in SEEDS:
        line = town_loop(seed, 640.0).line
        assert line.point(0.0, -LANE_CENTRES_M[0]) == pytest.approx(np.zeros(2), abs=1e-9)
        assert float(line.heading(0.0)) == pytest.approx(0.0, abs=1e-9)
        assert np.abs(line.curvature(np.linspace(-5.0, 20.0, 60))).max() < 1e-6


@pytest.mark.parametrize("n", [-6.0, 0.0, 5.0])
def test_heading_is_the_direction_of_the_points(n: float) -> None:
    plan = survey_town(DriveOptions(world="town", seed=3)).plan
    lines = [plan.loop, *(arm for crossing in plan.crossings for arm in (crossing.left, crossing.right) if arm)]
    for line in lines:
        s = np.linspace(1.0, line.length_m - 1.0, 700)
        step = line.point(s + 1e-3, n) - line.point(s - 1e-3, n)
        heading = np.asarray(line.heading(s))
        assert np.arctan2(step[:, 1], step[:, 0]) == pytest.approx((heading + np.pi) % (2 * np.pi) - np.pi, abs=2e-3)


def test_line_through_points_keeps_to_them_and_goes_straight_on() -> None:
    angle = np.linspace(0.0, 1.2, 400)
    arc = 30.0 * np.stack([np.sin(angle), 1.0 - np.cos(angle)], axis=1)
    line = line_through(arc)
    middle = line.point(0.5 * line.length_m, 0.0)
    assert middle == pytest.approx(30.0 * np.array([np.sin(0.6), 1.0 - np.cos(0.6)]), abs=5e-3)
    assert line.point(line.length_m, 0.0) == pytest.approx(arc[-1], abs=1e-6)
    beyond = line.point(line.length_m + 5.0, 0.0) - arc[-1]
    assert beyond == pytest.approx(5.0 * np.array([np.cos(1.2), np.sin(1.2)]), abs=5e-2)
    back = line.part(line.length_m, from_end=True)
    assert back.point(10.0, 2.0) == pytest.approx(line.point(line.length_m - 10.0, -2.0), abs=1e-3)


@pytest.mark.parametrize("max_slope", [0.0, 0.05, 0.12])
def test_streets_are_as_steep_as_asked_and_no_steeper(max_slope: float) -> None:
    for seed in range(3):
        town = survey(seed, max_slope=max_slope)
        steepest = 0.0
        for line in (town.loop.line, *(street.line for street in town.streets)):
            s = np.arange(0.0, line.length_m, 1.0)
            height = town.ground.hills.height_m(line.point(s, 0.0))
            steepest = max(steepest, float(np.abs(np.diff(height)).max()))
        assert 0.6 * max_slope <= steepest <= max_slope + 1e-9
        assert float(town.ground.hills.height_m(np.zeros(2))) == pytest.approx(0.0, abs=1e-9)


def test_junctions_lie_beside_the_loop_and_lead_far_away_from_it() -> None:
    arms = 0
    for seed in range(12):
        town = survey(seed)
        loop, length_m = town.loop.line, town.loop.line.length_m
        samples = loop.point(np.arange(0.0, length_m, 1.0), 0.0)
        places = np.array([crossing.s_m for crossing in town.plan.crossings])
        assert len(places) >= 3
        assert (np.diff(places) >= 40.0).all()
        assert around(places, length_m).min() >= 20.0
        for crossing in town.plan.crossings:
            assert crossing.left or crossing.right
            for arm, side in ((crossing.left, 1.0), (crossing.right, -1.0)):
                if arm is None:
                    continue
                arms += 1
                assert arm.point(0.0, 0.0) == pytest.approx(loop.point(crossing.s_m, 0.0), abs=1e-6)
                square = float(loop.heading(crossing.s_m)) + 0.5 * np.pi * side
                assert np.cos(float(arm.heading(0.0)) - square) > 0.999
                out = arm.point(np.arange(SIDE_STOP_M, arm.length_m, 2.0), 0.0)
                assert np.linalg.norm(out[:, None] - samples[None], axis=-1).min() > KERB_M + 1.0
        for street in town.streets:
            assert street.line.length_m >= (64.0 if street.end else 130.0)
    assert arms > 60


def test_some_streets_cut_through_the_blocks_and_some_junctions_have_four_arms() -> None:
    towns = [survey(seed) for seed in range(12)]
    assert sum(street.end is not None for town in towns for street in town.streets) >= 6
    assert sum(bool(c.left and c.right) for town in towns for c in town.plan.crossings) >= 6


def test_side_streets_keep_clear_of_each_other() -> None:
    for seed in range(12):
        streets = survey(seed).streets
        for k, street in enumerate(streets):
            mine = street.line.point(np.arange(25.0, street.line.length_m - 25.0, 3.0), 0.0)
            for other in streets[:k]:
                theirs = other.line.point(np.arange(25.0, other.line.length_m - 25.0, 3.0), 0.0)
                assert np.linalg.norm(mine[:, None] - theirs[None], axis=-1).min() > 24.0


def test_zebra_crossings_keep_clear_of_junctions_and_of_the_start() -> None:
    found = 0
    for seed in range(12):
        plan = survey(seed).plan
        assert len(plan.zebras_m) >= 2
        found += len(plan.zebras_m)
        for zebra in plan.zebras_m:
            assert not plan.near_crossing(zebra, CROSSING_CLEAR_M)
            assert around(zebra, plan.loop.length_m) >= 30.0
    assert found >= 30


def test_same_seed_same_plan_whatever_the_traffic() -> None:
    def fingerprint(seed: int, traffic_seed: int | None = None) -> bytes:
        plan = survey_town(DriveOptions(world="town", seed=seed, traffic_seed=traffic_seed)).plan
        places = plan.loop.point(np.arange(0.0, 640.0, 3.0), 2.0)
        crossings = np.array([crossing.s_m for crossing in plan.crossings])
        return places.tobytes() + plan.ground.height_m(places).tobytes() + crossings.tobytes()

    assert fingerprint(5) == fingerprint(5) == fingerprint(5, traffic_seed=99)
    assert len({fingerprint(seed) for seed in range(5, 9)}) == 4


def test_closed_line_has_no_jump_in_heading_over_laps() -> None:
    line = SampledLine(np.linspace(0.0, 2.0 * np.pi, 401), 200.0, np.zeros(2), closed=True)
    s = np.arange(-450.0, 450.0, 0.5)
    assert np.diff(np.asarray(line.heading(s))) == pytest.approx(np.full(len(s) - 1, np.pi / 200.0), abs=1e-9)
    assert line.point(37.0, 3.0) == pytest.approx(line.point(-163.0, 3.0), abs=1e-9)
