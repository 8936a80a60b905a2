# SPDX-License-Identifier: Apache-2.0
"""The mesh of the ground is where the ground's height function says it is, without holes."""

from collections import defaultdict

import numpy as np
import pytest

from services.simulator.options import DriveOptions
from services.simulator.rendering.raycast import RayScene
from services.simulator.shapes.meshes import Mesh, merged
from services.simulator.worlds.town.ground import sampling_m
from services.simulator.worlds.town.layout.drape import Drape
from services.simulator.worlds.town.layout.markings import Markings
from services.simulator.worlds.town.layout.streets import streets_mesh, stretches
from services.simulator.worlds.town.layout.terrain import terrain_mesh
from services.simulator.worlds.town.layout.town import frontages
from services.simulator.worlds.town.profile import KERB_HEIGHT_M, KERB_M, PAVEMENT_EDGE_M
from services.simulator.worlds.town.survey import TownSurvey, survey_town

TEXTURE: dict[str, int] = defaultdict(int)
HIGH_M = 60.0


def ground_of(seed: int, max_slope: float) -> tuple[TownSurvey, Drape, Mesh]:
    town = survey_town(DriveOptions(world="town", seed=seed, max_slope=max_slope))
    drape = Drape(town.ground.hills, min(2.0, sampling_m(max_slope)))
    fronts, _ = frontages(town, np.random.default_rng(seed))
    return town, drape, merged([streets_mesh(town, drape, fronts, TEXTURE), terrain_mesh(town, drape, TEXTURE)])


def height_below(mesh: Mesh, xy: np.ndarray) -> np.ndarray:
    """Height of the topmost surface at places (N, 2)."""
    scene = RayScene(mesh.vertices, mesh.triangles, 1)
    height = []
    for place in xy:
        way, _ = scene.cast(np.array([*place, HIGH_M]), np.array([[0.0, 0.0, -1.0]], np.float32))
        height.append(HIGH_M - float(way[0]))
    return np.array(height)


@pytest.mark.parametrize(("seed", "max_slope"), [(7, 0.05), (8, 0.12), (12, 0.12)])
def test_mesh_is_as_high_as_the_ground_says(seed: int, max_slope: float) -> None:
    town, _, mesh = ground_of(seed, max_slope)
    rng = np.random.default_rng(seed)
    length_m = town.loop.line.length_m
    on_loop = town.loop.line.point(rng.uniform(0.0, length_m, 700), rng.uniform(-20.0, 20.0, 700))
    on_sides = [
        street.line.point(rng.uniform(0.0, street.line.length_m, 120), rng.uniform(-9.0, 9.0, 120))
        for street in town.streets
    ]
    at_mouths = [
        town.loop.line.point(mouth.s_m + rng.uniform(-14.0, 14.0, 120), mouth.side * rng.uniform(5.0, 18.0, 120))
        for mouth, _, _ in town.mouths
    ]
    places = np.concatenate([on_loop, *on_sides, *at_mouths])
    places = places[np.abs(town.ground.distances.outside_m(places)) > 0.3]
    error = np.abs(height_below(mesh, places) - town.ground.height_m(places))
    assert error.max() < 0.02


def test_paint_lies_above_the_mesh_but_hardly() -> None:
    town, drape, mesh = ground_of(12, 0.12)
    paint = Markings(town, drape, np.random.default_rng(1), TEXTURE).mesh()
    corners = paint.vertices[paint.triangles]
    middle = corners.mean(axis=1)
    some = np.random.default_rng(2).choice(len(middle), 1500, replace=False)
    above = middle[some, 2] - height_below(mesh, middle[some, :2])
    assert above.min() > 0.001
    assert above.max() < 0.04


def test_pavement_is_a_kerb_higher_than_the_carriageway() -> None:
    town = survey_town(DriveOptions(world="town", seed=9))
    line = town.loop.line
    s = np.array([s for s in np.arange(0.0, 640.0, 5.0) if not town.plan.near_crossing(float(s), 16.0)])
    for side in (-1.0, 1.0):
        road = line.point(s, side * (KERB_M - 0.5))
        pavement = line.point(s, side * (KERB_M + 0.5))
        step = town.ground.height_m(pavement) - town.ground.height_m(road)
        assert step == pytest.approx(np.full(len(s), KERB_HEIGHT_M), abs=0.08)
        assert town.ground.distances.outside_m(line.point(s, side * (KERB_M + 1.0))) == pytest.approx(
            np.ones(len(s)), abs=0.03
        )
        behind = town.ground.distances.behind_pavement_m(line.point(s, side * (PAVEMENT_EDGE_M + 2.0)))
        assert behind == pytest.approx(np.full(len(s), 2.0), abs=0.05)


def test_stretches_are_what_the_gaps_leave() -> None:
    assert stretches(100.0, []) == [(0.0, 100.0)]
    assert stretches(100.0, [(20.0, 30.0), (70.0, 80.0)]) == [(30.0, 70.0), (80.0, 120.0)]
    assert stretches(100.0, [(95.0, 105.0)]) == [(105.0, 195.0)]
