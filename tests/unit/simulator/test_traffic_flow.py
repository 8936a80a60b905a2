# SPDX-License-Identifier: Apache-2.0
"""The camera gets on, and meets on its way what a street has in store."""

from collections import defaultdict

import cv2
import numpy as np
import pytest

from services.simulator.options import DriveOptions
from services.simulator.worlds.town.traffic.car_following import Drivers, following_acceleration
from services.simulator.worlds.town.traffic.parking import parking_bays
from tests.unit.simulator.traffic_scene import planned, town

LATERAL_M_S2 = 2.5


def drive(seed: int, traffic: float, frames: int = 620, **others: float) -> DriveOptions:
    """Options of a town's drive."""
    return DriveOptions(world="town", seed=seed, traffic=traffic, frames=frames, **others)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("seed", "traffic", "least"), [(1, 0.0, 0.85), (3, 0.1, 0.85), (6, 0.1, 0.85), (1, 1.0, 0.34), (2, 1.0, 0.34)]
)
def test_the_camera_gets_on(seed: int, traffic: float, least: float) -> None:
    options = drive(seed, traffic)
    _, camera = planned(options)
    assert float(camera.distance_m(60.0)) / 60.0 >= least * options.speed_m_s


def test_corners_are_taken_slowly_enough() -> None:
    for seed in (1, 2):
        _, camera = planned(drive(seed, 0.0, speed_m_s=14.0))
        t = np.arange(0.0, 60.0, 0.1)
        poses = np.array([camera.world_from_camera(at) for at in t])
        yaw = np.unwrap(np.arctan2(poses[:, 1, 2], poses[:, 0, 2]))
        speed = np.linalg.norm(np.diff(poses[:, :2, 3], axis=0), axis=1) / 0.1
        felt = np.abs(np.diff(yaw)) / 0.1 * speed
        smooth = np.convolve(felt, np.full(5, 0.2), mode="valid")
        assert speed.max() > 10.0
        assert 1.0 < smooth.max() < LATERAL_M_S2


def test_the_camera_moves_smoothly_and_begins_where_it_should() -> None:
    _, camera = planned(drive(2, 0.6))
    poses = np.array([camera.world_from_camera(at) for at in np.arange(0.0, 60.0, 0.05)])
    assert np.allclose(poses[0, :2, 3], 0.0, atol=0.1)
    steps = np.diff(poses[:, :3, 3], axis=0) / 0.05
    assert np.abs(np.diff(steps, axis=0)).max() / 0.05 < 12.0
    turns = np.linalg.norm(np.diff(poses[:, :3, 2], axis=0), axis=1) / 0.05
    assert turns.max() < 0.7
    height = poses[:, 2, 3] - town(2).ground.height_m(poses[:, :2, 3])
    assert np.abs(height - 1.65).max() < 0.06


def test_without_traffic_nothing_moves() -> None:
    actors, _ = planned(drive(1, 0.0))
    assert len(actors) > 30
    assert all(actor.always_still for actor in actors)


def test_every_situation_occurs() -> None:
    met: dict[str, int] = defaultdict(int)
    for seed in (1, 3, 6):
        options = drive(seed, 0.45)
        actors, camera = planned(options)
        loop = town(seed).loop
        times = np.arange(0.0, 60.0, 0.75)
        poses = np.array([camera.world_from_camera(t) for t in times])
        speed = np.asarray(camera.speed_m_s(times))
        met["the camera stands and goes on"] += int(((speed[:-1] < 0.05) & (speed[1:] >= 0.05)).sum())
        around = np.arange(0.0, loop.length_m, 1.0)
        line = loop.point(around, 0.0)
        for actor in actors:
            if actor.always_still:
                continue
            states = [actor.at(t) for t in times]
            here = np.array([s.present for s in states])
            away = np.array([s.centre_m[:2] for s in states]) - poses[:, :2, 3]
            ahead_axis = poses[:, :2, 2] / np.linalg.norm(poses[:, :2, 2], axis=1)[:, None]
            along = np.einsum("ti,ti->t", away, ahead_axis)
            aside = away[:, 0] * -ahead_axis[:, 1] + away[:, 1] * ahead_axis[:, 0]
            velocity = np.array([s.velocity_m_s[:2] for s in states])
            towards = np.einsum("ti,ti->t", velocity, ahead_axis)
            near = here & (np.hypot(*away.T) < 40.0)
            moving = np.array([s.moving for s in states])
            if actor.category == "person":
                if actor.half_base_m == 0.0:
                    met["a person walks"] += int((near & moving).any())
                    on_foot = [np.hypot(*(line - s.centre_m[:2]).T).min() for s in np.array(states)[near]]
                    met["a person crosses"] += int(min(on_foot, default=np.inf) < 2.0)
                continue
            met[f"a {actor.category}"] += int(near.any())
            if not near.any():
                continue
            same = near & (towards > 1.0) & (np.abs(aside) < 5.0)
            met["ahead"] += int((same & (along > 6.0) & (np.abs(aside) < 1.6)).any())
            met["oncoming"] += int((near & (towards < -1.0)).any())
            overtaken = same & (np.abs(along) < 3.0) & (np.abs(aside) > 2.0)
            met["we overtake"] += int((overtaken & (towards < speed - 0.5)).any())
            met["we are overtaken"] += int((overtaken & (towards > speed + 0.5)).any())
            across = np.abs(velocity[:, 1] * ahead_axis[:, 0] - velocity[:, 0] * ahead_axis[:, 1])
            met["crossing"] += int((near & (across > 2.0) & (np.abs(towards) < across) & (along > 5.0)).any())
            started = here[:-1] & near[1:] & ~moving[:-1] & moving[1:]
            met["starting"] += int(started.any())
            met["stopping"] += int((near[1:] & moving[:-1] & ~moving[1:]).any())
    expected = ["ahead", "oncoming", "crossing", "starting", "stopping", "we overtake", "we are overtaken"]
    expected += ["a person walks", "a person crosses", "the camera stands and goes on"]
    expected += ["a car", "a truck", "a bus", "a bicycle"]
    assert not [name for name in expected if not met[name]]


def test_cars_pull_out_of_bays() -> None:
    found = 0
    for seed in (1, 2, 3):
        actors, _ = planned(drive(seed, 0.45))
        bays = parking_bays(town(seed))
        places = np.array([town(seed).loop.point(bay.s_m, 7.6 * (1.0 if bay.way else -1.0)) for bay in bays])
        for actor in actors:
            first, last = actor.at(0.0), actor.at(60.0)
            stood = not first.moving and np.hypot(*(places - first.centre_m[:2]).T).min() < 1.6
            far = float(np.linalg.norm(last.centre_m - first.centre_m)) > 20.0
            found += int(stood and far and actor.category == "car")
    assert found >= 2


def test_a_driver_keeps_his_distance_and_speed() -> None:
    drivers = Drivers(*(np.full(4, value) for value in (1.5, 2.0, 1.2, 2.0)))
    speed, wanted = np.array([8.0, 8.0, 8.0, 12.0]), np.full(4, 8.0)
    gap, leader = np.array([np.inf, 2.0 + 8.0 * 1.2, 6.0, np.inf]), np.full(4, 8.0)
    free, even, close, fast = following_acceleration(drivers, speed, wanted, gap, leader)
    assert free == pytest.approx(0.0, abs=1e-9)
    assert even == pytest.approx(0.0, abs=1e-9)
    assert close < -1.0
    assert -2.0 <= fast < -0.5


def moving_share(options: DriveOptions) -> float:
    """Median share of a 640x192 image that the cuboids of what moves cover; nothing hides them here."""
    actors, camera = planned(options)
    movers = [actor for actor in actors if not actor.always_still]
    box = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])
    shares = []
    for t_s in np.arange(0.0, 30.0, 1.0):
        pose = camera.world_from_camera(t_s)
        image = np.zeros((96, 320), np.uint8)
        for actor in movers:
            state = actor.at(t_s)
            if not (state.present and state.moving):
                continue
            world = box * actor.size_m @ state.world_from_object[:3, :3].T + state.world_from_object[:3, 3]
            point = (world - pose[:3, 3]) @ pose[:3, :3]
            if point[:, 2].min() > 0.5 and point[:, 2].max() < 90.0:
                pixel = point[:, :2] / point[:, 2:] * 190.7 + [159.5, 47.5]
                cv2.fillConvexPoly(image, cv2.convexHull(pixel.round().astype(np.int32)), 1)
        shares.append(image.mean())
    return float(np.median(shares))


def test_traffic_says_how_much_of_the_image_moves() -> None:
    little, usual, dense = (
        np.mean([moving_share(drive(seed, traffic, 320)) for seed in (1, 2)]) for traffic in (0.1, 0.3, 1.0)
    )
    assert little < usual < dense
    assert 0.02 < usual < 0.15
    assert dense > 0.2
