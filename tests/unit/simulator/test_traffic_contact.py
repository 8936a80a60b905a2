# SPDX-License-Identifier: Apache-2.0
"""Nobody touches anybody in the town, the camera's car included."""

from dataclasses import replace

import numpy as np
import pytest

from services.simulator.options import DriveOptions
from tests.unit.simulator.traffic_scene import camera_car, footprint, gaps, planned


def closest(options: DriveOptions, end_s: float, step_s: float) -> tuple[float, int]:
    """The least gap of any two, one of whom can move, and how many pairs came within a metre of each other."""
    actors, camera = planned(options)
    movers = [actor for actor in actors if not actor.always_still]
    rides = {actor.instance_id for actor in actors if actor.category == "bicycle"}
    standing = np.array([footprint(actor, 0.0) for actor in actors if actor.always_still]).reshape(-1, 4, 2)
    least, near = np.inf, 0
    for t_s in np.arange(0.0, end_s, step_s):
        there = [actor for actor in movers if actor.at(t_s).present]
        ids = [0, *(actor.instance_id for actor in there)]
        moving = np.array([camera_car(camera, t_s), *(footprint(actor, t_s) for actor in there)])
        rectangles = np.concatenate([moving, standing])
        centre = rectangles.mean(axis=1)
        reach = np.linalg.norm(rectangles[:, 0] - centre, axis=1)
        apart = np.linalg.norm(centre[: len(ids), None] - centre[None], axis=2)
        pairs = np.argwhere(apart < reach[: len(ids), None] + reach[None])
        pairs = pairs[pairs[:, 0] < pairs[:, 1]]
        # A rider's number follows his bicycle's.
        ridden = [b < len(ids) and ids[a] in rides and ids[b] == ids[a] + 1 for a, b in pairs]
        between = gaps(rectangles, pairs[~np.array(ridden, bool)])
        least, near = min(least, float(between.min(initial=np.inf))), near + int((between < 1.0).sum())
    return least, near


@pytest.mark.parametrize(
    "options",
    [
        DriveOptions(world="town", seed=1, traffic=1.0),
        DriveOptions(world="town", seed=2, traffic=0.3),
        DriveOptions(world="town", seed=7, traffic=0.6, parked=1.0),
        DriveOptions(world="town", seed=3, traffic=0.6, lateral_offset_m=1.2),
        DriveOptions(world="town", seed=4, traffic=0.6, lateral_offset_m=-1.2, speed_m_s=13.0),
    ],
)
def test_nobody_touches_anybody(options: DriveOptions) -> None:
    least, near = closest(options, 24.0, 0.6)
    assert least > 0.0
    assert near > 20


@pytest.mark.parametrize("lateral_offset_m", [0.0, 1.0, -1.0])
def test_parked_lanes_are_full_and_leave_the_camera_its_way(lateral_offset_m: float) -> None:
    few = DriveOptions(world="town", seed=7, traffic=0.0, parked=1.0, lateral_offset_m=lateral_offset_m)
    full = replace(few, parked_lanes=1.0)
    actors, camera = planned(full)
    assert all(actor.always_still for actor in actors)
    assert len(actors) > len(planned(few)[0]) + 80
    standing = np.array([footprint(actor, 0.0) for actor in actors if actor.category != "person"])
    pairs = np.array([(a, b) for a in range(len(standing)) for b in range(a)])
    assert gaps(standing, pairs).min() > 0.0
    against_camera = np.array([(0, 1 + k) for k in range(len(standing))])
    for t_s in np.arange(0.0, 79.0, 0.5):
        assert gaps(np.concatenate([[camera_car(camera, t_s)], standing]), against_camera).min() > 0.2


def test_the_check_itself_finds_contact() -> None:
    square = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])
    turned = square @ (np.array([[1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2.0))
    rectangles = np.array([square, turned + np.array([2.3, 0.0]), turned + np.array([2.5, 0.0])])
    found = gaps(rectangles, np.array([[0, 1], [0, 2]]))
    assert found[0] == pytest.approx(2.3 - 1.0 - np.sqrt(2.0))
    assert found[1] > 0.0
