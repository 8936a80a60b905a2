# SPDX-License-Identifier: Apache-2.0
import json
from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import (
    Density,
    DensityLevel,
    MaskSource,
    TrackedFrame,
    TrackingState,
    TrueInstances,
    TrueObject,
    TruePose,
)
from schemas.topics import Topic
from services.evaluation.density.error import DensityFrame, density_error
from services.evaluation.density.plots import plot_density_error
from services.evaluation.density.session import read_densities
from services.evaluation.density.table import density_rows
from services.evaluation.density.truth import TrueDensity, TrueDensityRules
from services.runtime.errors import InputError
from services.runtime.session_file import RecordedMessage

mcap_writer = pytest.importorskip("services.recorder.session_writer")
S = 1_000_000_000


def _object(instance_id: int, x: float, *, moving: bool = True, height_px: float = 50.0) -> TrueObject:
    return TrueObject(instance_id, "car", moving, (2.0 * moving, 0.0, 0.0), (x, 0.0, 0.0), (0.0, 0.0, 9.0, height_px))


def _frame(time_s: int, *objects: TrueObject) -> TrueInstances:
    return TrueInstances(time_s * S, np.zeros((4, 6), dtype=np.uint32), objects)


def _at(density: TrueDensity, time_s: float, window_s: float, x: float = 0.0) -> int:
    return density.at(round(time_s * S), np.array((x, 0.0, 0.0)), 10.0, window_s)


def test_an_object_counts_where_it_was_last_seen_moving() -> None:
    density = TrueDensity()
    density.add(_frame(0, _object(1, 5.0), _object(2, 5.0)))
    density.add(_frame(1, _object(1, 30.0), _object(2, 5.0, moving=False)))
    assert _at(density, 0, 30.0) == 2
    assert _at(density, 1, 30.0) == 1  # 1 has driven off, 2 stopped beside us a second ago
    assert _at(density, 1, 0.5) == 0
    assert _at(density, 1, 1.0) == 1  # the window's end counts
    assert _at(density, 1, 30.0, x=30.0) == 1
    assert _at(density, 1, float("inf")) == 2  # ever: 1 was here too


def test_nothing_is_known_before_it_happens_and_nothing_unseen_counts() -> None:
    density = TrueDensity(TrueDensityRules(minimum_height_px=20.0))
    density.add(_frame(0, _object(3, 5.0, height_px=19.0), _object(4, 5.0, moving=False)))
    density.add(_frame(5, _object(5, 5.0, height_px=20.0)))
    assert [_at(density, t, 30.0) for t in (0, 4.9, 5)] == [0, 0, 1]


def _said(level: DensityLevel, said: int, true: int) -> DensityFrame:
    return DensityFrame(0, level, said, 10 * said, true)


def test_errors_and_levels_are_counted_and_unknown_stands_apart() -> None:
    low, high, unknown = DensityLevel.LOW, DensityLevel.HIGH, DensityLevel.UNKNOWN
    placed = [_said(high, 3, 1), _said(high, 1, 0), _said(low, 0, 2), _said(low, 0, 0), _said(low, 0, 0)]
    error = density_error([*placed, _said(unknown, 0, 9), _said(unknown, 0, 0), _said(unknown, 0, 0)])
    assert (error.frames, error.compared, error.coverage) == (8, 5, pytest.approx(0.625))
    assert error.mean_absolute_objects == pytest.approx((2 + 1 + 2) / 5)
    assert error.bias_objects == pytest.approx((2 + 1 - 2) / 5)
    counts = (error.true_positives, error.false_positives, error.false_negatives, error.true_negatives)
    assert counts == (1, 1, 1, 2)
    assert (error.precision, error.recall) == (0.5, 0.5)
    assert (error.unknown_truly_high, error.unknown_truly_low) == (1, 2)


def test_what_is_not_defined_is_none() -> None:
    error = density_error([_said(DensityLevel.UNKNOWN, 0, 0)])
    assert (error.mean_absolute_objects, error.precision, error.recall, error.coverage) == (None, None, None, 0.0)
    with pytest.raises(InputError, match="nothing to compare"):
        density_error([])


def _session(path: Path, *, metric: bool = True, without: str = "", units_a_metre: float = 1.0) -> Path:
    """A drive of one metre a frame towards an object that moves at x = 12.5; the map is `units_a_metre` as large."""
    messages = []
    for number in range(8):
        time_ns = number * S
        pose = np.eye(4)
        pose[:3, 3] = (number, 0.1 * number**2, 0.0)
        map_from_camera = np.array([*(units_a_metre * pose[:3, 3]), 0.0, 0.0, 0.0, 1.0])
        placed = number > 0
        x, y, z = map_from_camera[:3].tolist() if placed else [float("nan")] * 3
        level = (DensityLevel.HIGH if number >= 5 else DensityLevel.LOW) if placed else DensityLevel.UNKNOWN
        tracked = TrackedFrame(
            timestamp_ns=time_ns,
            state=TrackingState.TRACKING,
            reason="",
            map_id=0,
            map_from_camera=map_from_camera,
            covariance=None,
            reference_keyframe_id=0,
            camera_from_reference=None,
            features=9,
            tracked_landmarks=9,
            keyframe_inserted=False,
            masks=MaskSource.FRESH,
            metric_scale=metric,
            handling="moving",
        )
        density = Density(
            timestamp_ns=time_ns,
            position=(x, y, z),
            radius=10.0 * units_a_metre,
            window_s=30.0,
            moving_points=99 * (number >= 5),
            moving_objects=int(number >= 5),
            observed_points=9,
            level=level,
            metric_scale=metric and placed,
        )
        records: list[tuple[Topic, object]] = [
            (topics.TRUE_POSE, TruePose(time_ns, pose)),
            (topics.TRUE_INSTANCES, _frame(number, _object(1, 12.5))),
            (topics.TRACKED_FRAME, tracked),
            (topics.DENSITY, density),
        ]
        messages += [
            RecordedMessage(topic.key, number, time_ns, encode(topic, record))
            for topic, record in records
            if topic.key != without
        ]
    config = {"mapstore": {"base_from_camera": [0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5]}}
    writer = mcap_writer.SessionWriter(path, "drive", json.dumps(config))
    writer.append(messages)
    writer.finish()
    writer.close()
    return path


# The way to (12.5, 0) is below 10 m from frame 3 on: (3, 0.9) is 9.54 m away, (2, 0.4) is 10.51 m.
def test_a_session_is_read_with_its_own_radius_and_window(tmp_path: Path) -> None:
    densities = read_densities(_session(tmp_path / "a.mcap"))
    assert (densities.radius, densities.window_s, densities.metres_per_unit) == (10.0, 30.0, 1.0)
    assert [frame.true_objects for frame in densities.frames] == [0, 0, 0, 1, 1, 1, 1, 1]
    error = density_error(densities.frames)
    assert (error.frames, error.compared, error.unknown_truly_low) == (8, 7, 1)
    assert (error.true_positives, error.false_negatives, error.true_negatives) == (3, 2, 2)
    assert error.mean_absolute_objects == pytest.approx(2 / 7)
    assert ("recall of high", "0.600 (87.5%)") in density_rows(densities, error)
    plot_density_error(densities, tmp_path / "density.png")
    assert (tmp_path / "density.png").read_bytes().startswith(b"\x89PNG")


def test_an_arbitrary_scale_is_brought_to_metres(tmp_path: Path) -> None:
    densities = read_densities(_session(tmp_path / "a.mcap", metric=False, units_a_metre=4.0))
    assert (densities.radius, densities.metres_per_unit) == (40.0, pytest.approx(0.25))
    assert [frame.true_objects for frame in densities.frames] == [0, 0, 0, 1, 1, 1, 1, 1]


@pytest.mark.parametrize("topic", [topics.DENSITY, topics.TRUE_POSE, topics.TRUE_INSTANCES])
def test_a_session_without_truth_is_one_clear_line(tmp_path: Path, topic: Topic) -> None:
    session = _session(tmp_path / "a.mcap", without=topic.key)
    with pytest.raises(InputError, match=f"no {topic.key} in it, expected the session of a run") as raised:
        read_densities(session)
    assert "\n" not in str(raised.value)
