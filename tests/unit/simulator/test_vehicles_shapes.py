# SPDX-License-Identifier: Apache-2.0
"""The shapes of the town's vehicles and people: light, of their size, and all textures they need are painted."""

import numpy as np
import pytest

from services.simulator.painting.town_library import paint_town_library
from services.simulator.shapes.townspeople import draw_clothes
from services.simulator.shapes.vehicles.styles import BICYCLE, CARS, KINDS, LARGE, VehicleStyle
from services.simulator.worlds.town.traffic.looks import Wardrobe


@pytest.fixture(scope="module")
def wardrobe() -> Wardrobe:
    """Looks with the town's own textures."""
    return Wardrobe({name: number for number, name in enumerate(paint_town_library(1))})


@pytest.mark.parametrize("style", KINDS, ids=lambda style: style.name)
def test_vehicles_fill_their_cuboid_and_are_light(style: VehicleStyle, wardrobe: Wardrobe) -> None:
    for look in range(6):
        looks = wardrobe.vehicle(style, look)
        low, high = looks["mesh"].vertices.min(axis=0), looks["mesh"].vertices.max(axis=0)
        assert len(looks["mesh"].triangles) <= 420
        length, width, height = style.size_m
        assert high[0] - low[0] == pytest.approx(length, abs=0.15)
        # Mirrors stand out on both sides.
        assert width - 0.1 <= high[1] - low[1] <= width + 0.45
        assert high[2] == pytest.approx(height, abs=0.08)
        assert low[2] == pytest.approx(0.0, abs=0.03)
        assert abs(high[0] + low[0]) < 0.15
    assert looks["category"] == style.category


def test_there_are_many_kinds() -> None:
    assert len(CARS) >= 8
    assert {style.category for style in KINDS} == {"car", "truck", "bus", "bicycle"}
    share = sum(style.share for style in LARGE) / sum(style.share for style in KINDS)
    assert 0.05 <= share <= 0.2


def test_people_are_of_many_builds_and_light(wardrobe: Wardrobe) -> None:
    people = [wardrobe.person(look) for look in range(60)]
    for person in people:
        assert len(person["mesh"].triangles) <= 300
        low, high = person["mesh"].vertices.min(axis=0), person["mesh"].vertices.max(axis=0)
        assert high[2] == pytest.approx(person["size_m"][2], abs=0.09)
        assert low[2] == pytest.approx(0.0, abs=0.02)
    heights = np.array([person["size_m"][2] for person in people])
    assert heights.min() < 1.4
    assert heights.max() > 1.8
    clothes = [draw_clothes(np.random.default_rng(k)) for k in range(60)]
    assert {c.skirt for c in clothes} == {c.coat for c in clothes} == {c.bag for c in clothes} == {True, False}
    assert len({(c.top, c.top_tint) for c in clothes}) > 25


def test_a_rider_sits_on_his_bicycle_and_pedals(wardrobe: Wardrobe) -> None:
    bicycle, rider = wardrobe.vehicle(BICYCLE, 3), wardrobe.rider(3)
    assert rider["category"] == "person"
    assert rider["half_base_m"] == bicycle["half_base_m"]
    gait, vertices = rider["gait"], rider["mesh"].vertices
    assert gait is not None
    moved = np.linalg.norm(gait.swung(vertices, 1.2) - vertices, axis=1)
    assert moved.max() > 0.05
    assert (moved < 1e-9).mean() > 0.4
    assert vertices[:, 2].min() > 0.1
