# SPDX-License-Identifier: Apache-2.0
"""What stands in the town: beside the streets, never on them, and nowhere twice the same."""

from collections import defaultdict
from itertools import pairwise

import cv2
import numpy as np
import pytest
from scipy.spatial import cKDTree

from services.simulator.options import DriveOptions
from services.simulator.painting.buildings.storeys import STYLES, paint_plain, paint_storeys
from services.simulator.painting.town_library import paint_town_library
from services.simulator.shapes.meshes import Mesh
from services.simulator.worlds.town.layout.character import draw_characters
from services.simulator.worlds.town.layout.site import Site
from services.simulator.worlds.town.layout.town import town_mesh
from services.simulator.worlds.town.profile import WALKWAY_M
from services.simulator.worlds.town.survey import TownSurvey, survey_town
from tests.unit.simulator.traffic_scene import planned

TEXTURE: dict[str, int] = defaultdict(int)
HEIGHTS_M = (0.45, 1.0, 1.8)
"""Above the ground, where a car or a walker would run into something."""


def built(seed: int, **wanted: float) -> tuple[TownSurvey, Mesh]:
    options = DriveOptions(world="town", seed=seed, **wanted)  # type: ignore[arg-type]
    town = survey_town(options)
    return town, town_mesh(town, seed, options.max_slope, TEXTURE)


def obstacles(town: TownSurvey, mesh: Mesh) -> np.ndarray:
    """Places (N, 2), at most 0.4 m apart, where surfaces are cut at some heights above the ground."""
    corners = mesh.vertices[mesh.triangles]
    above = corners[..., 2] - town.ground.hills.height_m(corners[..., :2])
    points = []
    for height in HEIGHTS_M:
        over = above > height
        cut = over.any(axis=1) & ~over.all(axis=1)
        # The corner that is alone on its side of the cut, and the two edges that lead away from it.
        alone = np.where(over[cut].sum(axis=1) == 1, over[cut].argmax(axis=1), over[cut].argmin(axis=1))
        row = np.arange(len(alone))
        ends = []
        for k in (1, 2):
            other = (alone + k) % 3
            high, low = above[cut][row, alone], above[cut][row, other]
            share = ((height - high) / (low - high))[:, None]
            a, b = corners[cut][row, alone, :2], corners[cut][row, other, :2]
            ends.append(a + share * (b - a))
        length = np.linalg.norm(ends[1] - ends[0], axis=1)
        for steps in np.unique(np.ceil(length[length < 100.0] / 0.4)).astype(int):
            mine = np.ceil(length / 0.4).astype(int) == steps
            u = np.linspace(0.0, 1.0, steps + 1)[:, None]
            points.append((ends[0][mine, None] + u * (ends[1] - ends[0])[mine, None]).reshape(-1, 2))
    return np.concatenate(points)


@pytest.mark.parametrize(("seed", "max_slope"), [(7, 0.05), (10, 0.12)])
def test_nothing_stands_on_a_carriageway_or_where_people_walk(seed: int, max_slope: float) -> None:
    town, mesh = built(seed, max_slope=max_slope)
    assert len(mesh.triangles) < 400_000
    in_the_way = obstacles(town, mesh)
    assert len(in_the_way) > 20_000
    distances = town.ground.distances
    assert distances.outside_m(in_the_way).min() > 0.0
    # Where people walk along the loop, away from the mouths of side streets.
    line = town.loop.line
    s = np.array([s for s in np.arange(0.0, line.length_m, 0.25) if not town.plan.near_crossing(float(s), 16.0)])
    middle, half = 0.5 * (WALKWAY_M[0] + WALKWAY_M[1]), 0.5 * (WALKWAY_M[1] - WALKWAY_M[0])
    way = np.concatenate([line.point(s, side * middle) for side in (-1.0, 1.0)])
    gap, _ = cKDTree(in_the_way).query(way)
    assert gap.min() > half - 0.03


def test_same_seed_same_bytes_and_other_seeds_other_towns() -> None:
    meshes = [built(seed)[1] for seed in (4, 4, 5)]
    first, again, other = (mesh.vertices.tobytes() + mesh.uv.tobytes() + mesh.tint.tobytes() for mesh in meshes)
    assert first == again
    assert first != other


def test_neighbouring_streets_never_share_their_mix() -> None:
    for seed in range(10):
        characters = draw_characters(np.random.default_rng(seed), 9)
        for before, after in pairwise(characters):
            assert not {side.mix for side in before} & {side.mix for side in after}


def test_ground_is_taken_once() -> None:
    town = survey_town(DriveOptions(world="town", seed=2))
    site = Site(town.ground.distances, town.ground.hills)
    line = town.loop.line
    on_road = site.pose(line, 30.0, 0.0)
    assert not site.is_free(on_road, (2.0, 2.0))
    assert not site.take(on_road, (2.0, 2.0))
    beyond = site.pose_at(town.centre + 1e5, 0.0)
    assert not site.take(beyond, (2.0, 2.0))
    for n in np.arange(18.0, 60.0, 3.0):
        pose = site.pose(line, 30.0, float(n))
        if site.take(pose, (6.0, 6.0)):
            assert not site.is_free(pose, (1.0, 1.0))
            assert not site.take(pose, (6.0, 6.0))
            return
    pytest.fail("no free ground beside the first street")


def test_painted_storeys_stand_out_from_plain_walls() -> None:
    rng = np.random.default_rng(1)
    for style in STYLES:
        plain, storeys = paint_plain(rng, style), paint_storeys(rng, style)
        assert plain.shape == (256, 256, 3)
        assert storeys.shape == (512, 1024, 3)
        detail = [cv2.Laplacian(image, cv2.CV_32F).std() for image in (storeys[:256], plain)]
        assert detail[0] > 12.0
        assert storeys[:256].std() > plain.std()


def test_textures_fit_the_atlas_and_follow_from_the_seed() -> None:
    first, again, other = (paint_town_library(seed) for seed in (3, 3, 4))
    assert list(first) == list(again) == list(other)
    for name, image in first.items():
        assert image.dtype == np.uint8
        assert all(side & (side - 1) == 0 for side in image.shape[:2]), name
        assert np.array_equal(image, again[name])
    assert sum(image.nbytes for image in first.values()) < 90e6
    differing = sum(not np.array_equal(image, other[name]) for name, image in first.items())
    assert differing > 0.9 * len(first)


def test_nobody_runs_into_what_stands() -> None:
    town, mesh = built(7)
    standing = obstacles(town, mesh)
    tree = cKDTree(standing)
    actors, _ = planned(DriveOptions(world="town", seed=7, traffic=0.6, parked=1.0))
    assert len(actors) > 100
    for actor in actors:
        half = 0.5 * np.array(actor.size_m[:2])
        for t_s in np.arange(0.0, 30.0, 2.5):
            state = actor.at(float(t_s))
            if not state.present:
                continue
            near = standing[tree.query_ball_point(state.centre_m[:2], float(np.hypot(*half)))]
            inside = np.abs((near - state.world_from_object[:2, 3]) @ state.world_from_object[:2, :2]) < half
            assert not inside.all(axis=1).any()
