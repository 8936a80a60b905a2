# SPDX-License-Identifier: Apache-2.0
"""Density against the definition, point by point, on maps that hypothesis makes up."""

import math
from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from schemas.records import DensityLevel, MapUpdate, MotionState
from services.mapstore.density import DynamicDensity
from services.mapstore.map_state import MapState
from services.mapstore.map_view import MapView
from tests.unit.mapstore.street_map import FRAME_NS, keyframe_id, landmarks, tracked, view_of, with_keyframes


@dataclass(frozen=True)
class Question:
    position: np.ndarray
    radius: float
    window_s: float


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def definition(update: MapUpdate, cameras: np.ndarray, now_ns: int, question: Question) -> tuple[int, int, int, bool]:
    """Moving points, moving objects, points of any kind, and whether the place was observed: DESIGN.md word by word."""
    inside, moving = 0, []
    last_seen: defaultdict[int, int] = defaultdict(lambda: -1)
    row_of = {number: row for row, number in enumerate(update.keyframe_id.tolist())}
    for row in range(len(update.landmark_id)):
        pose = update.keyframe_pose[row_of[int(update.landmark_anchor_id[row])]]
        here = update.keyframe_map_id[row_of[int(update.landmark_anchor_id[row])]] == 1
        point = pose[7] * rotation_of(pose[3:7]) @ update.landmark_position[row].astype(np.float64) + pose[:3]
        distance = np.linalg.norm(point - question.position)
        assume(abs(distance - question.radius) > 1e-6)
        seen_ns, number = int(update.landmark_last_seen_ns[row]), int(update.landmark_object_id[row])
        is_moving = update.landmark_state[row] == MotionState.MOVING
        if is_moving and seen_ns <= now_ns:
            last_seen[number] = max(last_seen[number], seen_ns)
        if here and distance <= question.radius:
            inside += 1
            if is_moving:
                moving.append((number, seen_ns))
    if math.isinf(question.window_s):
        counted = moving
    else:
        begin_ns = now_ns - question.window_s * 1e9
        counted = [
            (number, seen_ns)
            for number, seen_ns in moving
            if begin_ns <= seen_ns <= now_ns and (number == 0 or seen_ns == last_seen[number])
        ]
    distances = np.linalg.norm(cameras - question.position, axis=1)
    assume(np.all(np.abs(distances - question.radius) > 1e-6))
    observed = inside > 0 or bool(np.any(distances <= question.radius))
    return len(counted), len({number for number, _ in counted if number}), inside, observed


@st.composite
def maps(draw: st.DrawFn) -> tuple[MapUpdate, int]:
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    keyframes, points = draw(st.integers(1, 6)), draw(st.integers(0, 60))
    frames = draw(st.integers(1, 8))
    update = with_keyframes(
        landmarks(
            0,
            0,
            np.arange(points),
            rng.normal(0, draw(st.sampled_from([0.5, 5.0])), (points, 3)),
            state=rng.integers(0, 5, points),
            object_id=rng.integers(0, 4, points),
            last_seen_ns=rng.integers(0, 10, points) * FRAME_NS,
            anchor_id=[keyframe_id(int(row)) for row in rng.integers(0, keyframes, points)],
        ),
        *range(keyframes),
    )
    poses = np.concatenate(
        [rng.normal(0, 4, (keyframes, 3)), rng.normal(0, 1, (keyframes, 4)), rng.uniform(0.3, 3, (keyframes, 1))],
        axis=1,
    )
    poses[:, 3:7] /= np.linalg.norm(poses[:, 3:7], axis=1, keepdims=True)
    return replace(update, keyframe_pose=poses, keyframe_map_id=rng.integers(1, 3, keyframes)), frames


def placed(update: MapUpdate, frames: int) -> tuple[MapView, np.ndarray]:
    """The map with cameras on its first keyframe, and where those are in the current map."""
    state = MapState()
    for frame in range(frames):
        state.add_frame(frame, tracked(frame, 0, float(frame)))
    state.apply(update)
    pose, rotation = update.keyframe_pose[0], rotation_of(update.keyframe_pose[0, 3:7])
    centres = np.array([pose[7] * rotation @ [0, 0, frame] + pose[:3] for frame in range(frames)])
    return state.view(), centres if update.keyframe_map_id[0] == 1 else np.empty((0, 3))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    made=maps(),
    position=st.tuples(*[st.floats(-8, 8)] * 3),
    radius=st.sampled_from([0.3, 1.0, 3.0, 10.0, 200.0]),
    window_s=st.sampled_from([0.0, 0.25, 0.5, 2.0, math.inf]),
)
def test_counts_what_the_definition_counts(
    made: tuple[MapUpdate, int], position: tuple[float, float, float], radius: float, window_s: float
) -> None:
    update, frames = made
    view, cameras = placed(update, frames)
    question = Question(np.array(position), radius, window_s)
    points, objects, inside, observed = definition(update, cameras, (frames - 1) * FRAME_NS, question)
    density = DynamicDensity(high_from_points=4).at(view, question.position, radius, window_s)
    assert (density.moving_points, density.moving_objects, density.observed_points) == (points, objects, inside)
    expected = DensityLevel.UNKNOWN if not observed else DensityLevel.HIGH if points >= 4 else DensityLevel.LOW
    assert density.level == expected


def test_ten_moving_points_are_high_and_nine_are_low() -> None:
    for points, level in ((9, DensityLevel.LOW), (10, DensityLevel.HIGH)):
        state = MapState()
        state.add_frame(0, tracked(0, 0))
        state.apply(with_keyframes(landmarks(0, 0, np.arange(points), np.ones((points, 3)), state=2, object_id=1), 0))
        assert DynamicDensity().at(state.view(), np.zeros(3), 10.0, 30.0).level == level


def test_a_passing_object_counts_once_within_the_window_and_every_time_with_all() -> None:
    view, density = view_of(21), DynamicDensity()
    place = np.array([20.0, 0.0, 0.0])
    windowed, ever = density.at(view, place, 100.0, 30.0), density.at(view, place, 100.0, math.inf)
    assert (windowed.moving_points, windowed.moving_objects) == (12, 1)
    assert (ever.moving_points, ever.moving_objects) == (60, 1)


def test_an_object_that_was_seen_elsewhere_since_does_not_count_here() -> None:
    state = MapState()
    here = landmarks(0, 0, np.arange(20), np.zeros((20, 3)), state=2, object_id=5)
    there = landmarks(1, 0, 20 + np.arange(20), np.full((20, 3), 50.0), state=2, object_id=5)
    state.add_frame(0, tracked(0, 0))
    state.apply(with_keyframes(here, 0))
    assert DynamicDensity().at(state.view(), np.zeros(3), 5.0, 30.0).level == DensityLevel.HIGH
    state.add_frame(1, tracked(1, 0))
    state.apply(there)
    assert DynamicDensity().at(state.view(), np.zeros(3), 5.0, 30.0).level == DensityLevel.LOW
    assert DynamicDensity().at(state.view(), np.zeros(3), 5.0, math.inf).moving_points == 20


def test_a_movement_is_forgotten_when_the_window_has_passed() -> None:
    state = MapState()
    state.apply(with_keyframes(landmarks(0, 0, np.arange(20), np.zeros((20, 3)), state=2, object_id=5), 0))
    for frame, points in ((10, 20), (11, 0)):
        state.add_frame(frame, tracked(frame, 0))
        assert DynamicDensity().at(state.view(), np.zeros(3), 5.0, 1.0).moving_points == points


def test_a_place_where_only_the_camera_was_is_low_and_one_where_nobody_was_is_unknown() -> None:
    state = MapState()
    for frame in range(4):
        state.add_frame(frame, tracked(frame, 0, float(frame)))
    state.apply(with_keyframes(MapUpdate(0), 0))
    density = DynamicDensity()
    assert density.at(state.view(), np.array([3.0, 0.0, 0.0]), 0.5, 30.0).level == DensityLevel.LOW
    assert density.at(state.view(), np.array([30.0, 0.0, 0.0]), 10.0, 30.0).level == DensityLevel.UNKNOWN


def test_a_map_correction_moves_the_points_with_their_keyframe() -> None:
    state = MapState()
    state.add_frame(0, tracked(0, 0))
    state.apply(with_keyframes(landmarks(0, 0, np.arange(20), np.zeros((20, 3)), state=2, object_id=5), 0))
    before = state.view()
    state.apply(with_keyframes(MapUpdate(0), 0, y=40.0))
    for view, y in ((before, 0.0), (state.view(), 40.0)):
        assert DynamicDensity().at(view, np.array([0.0, y, 0.0]), 1.0, 30.0).moving_points == 20
        assert DynamicDensity().at(view, np.array([0.0, 40.0 - y, 0.0]), 1.0, 30.0).level == DensityLevel.UNKNOWN


def test_without_a_pose_nothing_is_known() -> None:
    density = DynamicDensity().nowhere(view_of(3), 10.0, 30.0)
    assert density.level == DensityLevel.UNKNOWN
    assert all(math.isnan(number) for number in density.position)


@pytest.mark.parametrize("metric", [True, False])
def test_the_answer_says_whether_lengths_are_metres(metric: bool) -> None:
    state = MapState()
    state.add_frame(0, tracked(0, 0, metric_scale=metric))
    assert DynamicDensity().at(state.view(), np.zeros(3), 1.0, 1.0).metric_scale is metric
