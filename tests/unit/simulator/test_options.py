# SPDX-License-Identifier: Apache-2.0
"""Options of a drive: what is refused, and how."""

from collections import defaultdict
from typing import Any

import pytest

from services.runtime.errors import InputError
from services.simulator.camera.timeline import Timeline
from services.simulator.options import DriveOptions
from services.simulator.worlds.street.ego import EgoTrajectory
from services.simulator.worlds.street.road import Road
from services.simulator.worlds.street.traffic import TrafficPlanner


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("seed", -1),
        ("seed", 1.5),
        ("width", 0),
        ("height", 100_000),
        ("fx_px", -380.0),
        ("frames", 0),
        ("rate_hz", 0.0),
        ("rate_hz", float("nan")),
        ("speed_m_s", float("inf")),
        ("camera_height_m", -1.65),
        ("parked_cars", -3),
        ("walking_people", "many"),
        ("threads", True),
        ("empty_start_m", 1000.0),
        ("world", "moon"),
        ("light", 3),
        ("shadows", 1),
        ("distortion", (0.1,)),
        ("traffic_seed", 0.5),
    ],
)
def test_bad_option_is_refused_in_one_line_that_names_it(name: str, value: object) -> None:
    with pytest.raises(InputError) as caught:
        DriveOptions(**{name: value})  # type: ignore[arg-type]
    message = str(caught.value)
    assert name in message
    assert repr(value) in message
    assert "expected" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"world": "town", "parked_cars": 3}, "parked_cars=3: expected this option in the world street only"),
        ({"world": "town", "parked_lanes": 0.5}, "parked_lanes=0.5: expected 0 while there is traffic"),
        ({"world": "corridor", "loop_m": 900.0}, "loop_m=900.0: expected this option in the world town only"),
        ({"world": "street", "traffic": 0.0}, "traffic=0.0: expected this option in the world town or corridor only"),
        ({"blackout_start": 320, "blackout_frames": 1}, "blackout_start=320: expected a blackout that begins before"),
        ({"lens": "radial", "distortion": (1e308, -1e308, 1e308, 0.0, 0.0)}, "expected coefficients within 1000"),
        ({"seed": 2**32}, "seed=4294967296: expected 0 to 4294967295"),
    ],
    ids=str,
)
def test_an_option_that_could_only_be_passed_over_is_refused(options: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError) as caught:
        DriveOptions(**options)
    assert says in str(caught.value)


def test_a_drive_that_missing_frames_make_too_long_is_refused_by_what_was_asked_for() -> None:
    options = DriveOptions(frames=15_000, speed_m_s=13.0, missing_frames=0.2)
    with pytest.raises(InputError, match=r"frames=15000 with missing_frames=0\.2: expected a drive of at most 20000 m"):
        Timeline(options)


def test_more_traffic_than_the_street_holds_is_refused() -> None:
    options = DriveOptions(crossing_cars=60)
    road = Road(options.drive_length_m, options.seed)
    planner = TrafficPlanner(options, road, EgoTrajectory(options, road), defaultdict(int))
    with pytest.raises(InputError, match=r"crossing_cars=60: expected at most \d+ on this street"):
        planner.plan()


def test_timestamps_do_not_drift() -> None:
    assert DriveOptions().timestamp_ns(319) == 31_900_000_000
    thirds = DriveOptions(rate_hz=30.0)
    assert [thirds.timestamp_ns(i) for i in (0, 1, 2, 3, 300)] == [0, 33_333_333, 66_666_666, 100_000_000, 10**10]
