# SPDX-License-Identifier: Apache-2.0
"""What happens in the default drive: who moves, who is seen, and that nobody is run over."""

from collections import defaultdict

import cv2
import numpy as np
import pytest

from services.simulator.actors.actor import Actor
from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from services.simulator.worlds.street.ego import EgoTrajectory
from services.simulator.worlds.street.road import Road
from services.simulator.worlds.street.traffic import TrafficPlanner


def footprint(actor: Actor, t_s: float) -> np.ndarray:
    """Corners of an actor's rectangle on the ground, (4, 2)."""
    state = actor.at(t_s)
    half = 0.5 * np.array(actor.size_m[:2])
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * half
    return corners @ state.world_from_object[:2, :2].T + state.world_from_object[:2, 3]


def ego_footprint(ego: EgoTrajectory, t_s: float) -> np.ndarray:
    """Corners of the camera's car, whose camera stands a metre behind its bumper."""
    pose = ego.world_from_camera(t_s)
    ahead = pose[:2, 2] / np.linalg.norm(pose[:2, 2])
    left = np.array([-ahead[1], ahead[0]])
    return np.array([pose[:2, 3] + a * ahead + b * left for a, b in ((1, 0.9), (1, -0.9), (-3.2, -0.9), (-3.2, 0.9))])


def overlap(a: np.ndarray, b: np.ndarray) -> bool:
    area, _ = cv2.intersectConvexConvex(a.astype(np.float32), b.astype(np.float32))
    return area > 1e-3


def test_long_enough_with_curves_and_immediate_motion(street: Drive) -> None:
    poses = np.array([street.world_from_camera(i) for i in range(street.frame_count)])
    steps = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
    assert street.frame_count >= 300
    assert steps.sum() >= 200.0
    assert steps[0] > 0.5
    assert np.allclose(poses[0, :2, 3], 0.0, atol=1e-6)
    yaw = np.unwrap(np.arctan2(poses[:, 1, 2], poses[:, 0, 2]))
    assert abs(yaw[0]) < 0.02
    assert np.ptp(yaw) > np.deg2rad(15.0)
    assert np.abs(np.diff(yaw)).max() < np.deg2rad(1.5)
    assert np.allclose(np.einsum("nij,nkj->nik", poses[:, :3, :3], poses[:, :3, :3]), np.eye(3), atol=1e-9)


def test_starts_where_nothing_moves(street: Drive) -> None:
    for index in range(street.frame_count):
        t_s = street.timestamp_ns(index) * 1e-9
        if street.camera_path.distance_m(t_s) >= 60.0:
            break
        eye = street.world_from_camera(index)[:2, 3]
        states = [actor.at(t_s) for actor in street.actors]
        near = [s for s in states if s.moving and np.linalg.norm(s.centre_m[:2] - eye) < 30.0]
        assert not near
    assert index > 50


def test_every_kind_of_traffic_is_seen(street: Drive) -> None:
    seen: dict[int, list[tuple[bool, int, float]]] = defaultdict(list)
    categories = {}
    share = []
    for index in range(0, street.frame_count, 8):
        frame = street.render(index)
        moving_px = 0
        for found in frame.instances:
            along = float(found.velocity_m_s[:2] @ frame.world_from_camera[:2, 2])
            seen[found.instance_id].append((found.moving, found.box_px[3], along))
            categories[found.instance_id] = found.category
            moving_px += found.visible_px if found.moving else 0
        share.append(moving_px / frame.labels.size)
    big = {k: [v for v in values if v[1] >= 20] for k, values in seen.items()}
    cars = {k: v for k, v in big.items() if categories[k] == "car" and v}
    people = {k: v for k, v in big.items() if categories[k] == "person" and v}
    assert sum(all(not moving for moving, _, _ in v) for v in cars.values()) >= 10
    assert sum(any(not m for m, _, _ in v) and any(m for m, _, _ in v) for v in cars.values()) >= 2
    assert sum(any(m and along > 4.0 for m, _, along in v) for v in cars.values()) >= 1
    assert sum(any(m and along < -3.0 for m, _, along in v) for v in cars.values()) >= 3
    assert sum(any(m and abs(along) < 2.0 for m, _, along in v) for v in cars.values()) >= 1
    assert sum(any(m for m, _, _ in v) for v in people.values()) >= 8
    assert sum(all(not m for m, _, _ in v) for v in people.values()) >= 2
    assert 0.05 < max(share) < 0.25
    assert share[0] < 0.005


def test_instances_agree_with_labels_and_motion(street: Drive) -> None:
    for index in (0, 110, 190, 240):
        frame = street.render(index)
        assert frame.labels.dtype == np.uint16
        assert frame.depth_m.dtype == np.float32
        assert frame.image.shape == (192, 640, 3)
        assert {i.instance_id for i in frame.instances} == set(np.unique(frame.labels).tolist()) - {0}
        assert (frame.depth_m[frame.labels > 0] > 0.0).all()
        for found in frame.instances:
            rows, columns = np.nonzero(frame.labels == found.instance_id)
            x, y, width, height = found.box_px
            assert (columns.min(), rows.min()) == (x, y)
            assert (columns.max(), rows.max()) == (x + width - 1, y + height - 1)
            assert found.visible_px == len(rows)
            assert found.moving == (np.linalg.norm(found.velocity_m_s) >= 0.1)
            assert found.category in ("car", "person")
            point_in_camera = np.linalg.inv(frame.world_from_camera) @ [*found.position_m, 1.0]
            reach = 0.5 * np.linalg.norm(found.size_m) + 0.3
            depth = np.median(frame.depth_m[rows, columns])
            assert abs(depth - point_in_camera[2]) < reach


def test_velocity_is_the_derivative_of_position(street: Drive) -> None:
    step_s = 1e-3
    for t_s in (4.0, 13.0, 21.0):
        for actor in street.actors:
            before, now, after = (actor.at(t_s + k * step_s) for k in (-1, 0, 1))
            measured = (after.centre_m - before.centre_m)[:2] / (2.0 * step_s)
            assert measured == pytest.approx(now.velocity_m_s[:2], abs=0.02)
            assert now.moving == (np.linalg.norm(now.velocity_m_s) >= 0.1)


@pytest.mark.parametrize("seed", [7, 0, 1, 2, 3, 11, 26])
def test_nobody_touches_anybody_whatever_the_seed(seed: int) -> None:
    options = DriveOptions(seed=seed)
    road = Road(options.drive_length_m, seed)
    ego = EgoTrajectory(options, road)
    actors = TrafficPlanner(options, road, ego, defaultdict(int)).plan()
    assert len(actors) == 60
    for t_s in np.arange(0.0, 32.0, 0.35):
        boxes = [footprint(actor, t_s) for actor in actors if actor.at(t_s).present]
        boxes.append(ego_footprint(ego, t_s))
        centres = np.array([box.mean(axis=0) for box in boxes])
        for i in range(len(boxes)):
            near = np.flatnonzero(np.linalg.norm(centres[i + 1 :] - centres[i], axis=1) < 6.0) + i + 1
            assert not any(overlap(boxes[i], boxes[j]) for j in near)


def test_texture_feeds_orb_as_real_images_do() -> None:
    street = Drive(DriveOptions(width=1242, height=375))
    orb = cv2.ORB_create(nfeatures=2000)
    for index in (0, 100, 200, 300):
        image = cv2.cvtColor(street.render(index).image, cv2.COLOR_BGR2GRAY)
        assert len(orb.detect(image, None)) >= 1500
