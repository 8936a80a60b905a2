# SPDX-License-Identifier: Apache-2.0
"""Light and shadow fall where they should, and change nothing but the image."""

import numpy as np
import pytest

from services.simulator.camera.camera import Camera
from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from services.simulator.rendering.light import LIGHTS, Light
from services.simulator.rendering.nearest import Surfaces
from services.simulator.rendering.shadow import SunShadow, softened
from services.simulator.rendering.triangles import TriangleTable, table_of
from services.simulator.shapes.meshes import box, merged, quads
from services.simulator.worlds.build import build_world
from services.simulator.worlds.world import World

CAMERA = Camera(160, 100, 80.0)
# Three metres above the plane, looking straight down; columns go along x, rows against y.
LOOKING_DOWN = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 3.0], [0.0, 0.0, 0.0, 1.0]])
WORLDS: dict[str, World] = {}


@pytest.fixture(autouse=True)
def world_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def build(options: DriveOptions) -> World:
        if options.world not in WORLDS:
            WORLDS[options.world] = build_world(options)
        return WORLDS[options.world]

    monkeypatch.setattr("services.simulator.drive.build_world", build)


def table_on_a_plane(with_table: bool) -> Surfaces:
    ground = quads([[[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]], [[0, 0], [1, 0], [1, 1], [0, 1]], 0)
    mesh = merged([ground, box((1.0, 1.0, 0.1), (0.0, 0.0, 1.0), 0)]) if with_table else ground
    table: TriangleTable = table_of(mesh, mesh.vertices, np.zeros(len(mesh.triangles), np.int32))
    return Surfaces(table, 1)


def lit_from(direction: tuple[float, float, float], surfaces: list[Surfaces]) -> np.ndarray:
    x, y = CAMERA.normalised()
    shadow = SunShadow(np.array(direction) / np.linalg.norm(direction), surfaces)
    return shadow.lit(LOOKING_DOWN, x, y, np.full(x.shape, 3.0, np.float32), np.ones(x.shape, bool))


def ground_position(lit: np.ndarray) -> np.ndarray:
    """Middle of the shadow on the ground, metres."""
    x, y = CAMERA.normalised()
    dark = lit == 0.0
    return np.array([3.0 * x[dark].mean(), -3.0 * y[dark].mean()])


def test_shadow_lies_opposite_the_sun_as_far_as_its_height_says() -> None:
    lit = lit_from((1.0, 0.0, 1.0), [table_on_a_plane(True)])
    assert ground_position(lit) == pytest.approx([-1.0, 0.0], abs=0.06)
    assert (lit == 0.0).sum() * (3.0 / 80.0) ** 2 == pytest.approx(1.1, abs=0.1)
    assert ground_position(lit_from((0.0, 1.0, 2.0), [table_on_a_plane(True)])) == pytest.approx([0.0, -0.5], abs=0.06)
    assert lit_from((1.0, 0.0, 1.0), [table_on_a_plane(False)]).all()


def test_what_moves_casts_shadows_too() -> None:
    ground, table = table_on_a_plane(False), table_on_a_plane(True)
    assert np.array_equal(lit_from((1.0, 0.5, 1.0), [ground, table]), lit_from((1.0, 0.5, 1.0), [table]))


def test_borders_are_smoothed_among_sunny_pixels_only() -> None:
    lit = np.zeros((5, 9), np.float32)
    lit[:, 4:] = 1.0
    sunny = np.ones((5, 9), bool)
    sunny[:, 7:] = False
    smooth = softened(lit, sunny)
    assert smooth[2] == pytest.approx([0, 0, 0, 1 / 3, 2 / 3, 1, 1, 0, 0], abs=1e-6)


@pytest.mark.parametrize("light", ["low_sun", "overcast", "dusk"])
def test_light_changes_the_image_and_never_the_truth(light: str) -> None:
    size = {"width": 160, "height": 64}
    noon, other = Drive(DriveOptions(**size)).render(60), Drive(DriveOptions(**size, light=light)).render(60)
    assert np.array_equal(noon.depth_m, other.depth_m)
    assert np.array_equal(noon.labels, other.labels)
    assert np.abs(noon.image.astype(int) - other.image).mean() > 5.0


def test_each_light_has_its_mood() -> None:
    mean = {}
    for light in LIGHTS:
        image = Drive(DriveOptions(width=160, height=64, light=light)).render(60).image.astype(float)
        mean[light] = image.mean(axis=(0, 1))
    assert mean["dusk"].mean() < 0.6 * mean["noon"].mean()
    blue, _, red = mean["low_sun"]
    assert red > blue
    assert np.ptp(mean["overcast"]) < np.ptp(mean["low_sun"])


def test_shadows_only_darken() -> None:
    size = {"width": 160, "height": 64, "light": "low_sun"}
    without, with_them = Drive(DriveOptions(**size)).render(60), Drive(DriveOptions(**size, shadows=True)).render(60)
    change = with_them.image.astype(int) - without.image
    assert change.max() <= 0
    assert (change.min(axis=-1) < -20).mean() > 0.1
    assert np.array_equal(without.depth_m, with_them.depth_m)


def test_a_hidden_sun_casts_no_shadow() -> None:
    size = {"width": 160, "height": 64, "light": "overcast"}
    without, with_them = Drive(DriveOptions(**size)).render(60), Drive(DriveOptions(**size, shadows=True)).render(60)
    assert np.array_equal(without.image, with_them.image)


def test_every_sun_that_shines_stands_above_the_horizon() -> None:
    shining: list[Light] = [light for light in LIGHTS.values() if light.casts_shadows]
    assert shining
    assert all(light.direction_to_sun[2] > 0.1 for light in shining)
