# SPDX-License-Identifier: Apache-2.0
"""The map in memory: what updates do to it, and that views stay as they were."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.records import MapUpdate, MotionState
from services.mapstore.export.tum import trajectory_tum
from services.mapstore.landmark_table import LandmarkTable
from services.mapstore.map_state import MapState
from tests.unit.mapstore.street_map import (
    FRAME_NS,
    drive,
    keyframe_id,
    landmarks,
    tracked,
    view_of,
    waiting,
    with_keyframes,
)


def test_a_view_stays_as_it_was() -> None:
    state = MapState()
    state.add_frame(0, tracked(0, 0))
    state.apply(with_keyframes(landmarks(0, 0, np.arange(4), np.ones((4, 3))), 0))
    before = state.view()
    state.add_frame(1, tracked(1, 0, 1.0))
    state.apply(with_keyframes(landmarks(1, 0, np.arange(8), np.zeros((8, 3)), state=2, object_id=3), 0, 5, y=9.0))
    assert before.counts_by_state().tolist() == [4, 0, 0, 0, 0]
    assert before.keyframes.pose[:, 1].tolist() == [0.0]
    assert before.clusters[0].position.tolist() == [[1.0, 1.0, 1.0]] * 4
    assert (before.sequence, len(before.frames.sequence), before.sightings) == (0, 1, {})
    assert state.view().counts_by_state().tolist() == [0, 0, 8, 0, 0]


def test_final_poses_follow_their_keyframes_also_culled_ones() -> None:
    state = MapState()
    for frame in range(3):
        state.add_frame(frame, tracked(frame, 0, float(frame)))
    state.apply(with_keyframes(MapUpdate(0), 0))
    state.apply(with_keyframes(MapUpdate(0), 0, scale=2.0, y=7.0, culled=1))
    np.testing.assert_allclose(state.view().final_poses()[:, :3], [[0, 7, 0], [2, 7, 0], [4, 7, 0]], atol=1e-12)


def test_a_frame_without_a_known_keyframe_keeps_the_pose_it_was_reported_with() -> None:
    state = MapState()
    state.add_frame(0, tracked(0, 4, 0.5))
    np.testing.assert_allclose(state.view().final_poses()[0, :3], [4.5, 0, 0])


def test_poses_that_become_known_later_fill_their_frames() -> None:
    state = MapState()
    for frame in range(3):
        state.add_frame(frame, waiting(frame))
    relative = np.array([[0, 0, 1.0, 0, 0, 0, 1], [0, 0, 0.5, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 1]])
    known = replace(
        with_keyframes(MapUpdate(0, map_id=1), 2),
        frame_timestamp_ns=np.array([0, 1, 77]) * FRAME_NS,
        frame_reference_keyframe_id=np.full(3, keyframe_id(2)),
        frame_camera_from_reference=relative,
    )
    assert state.apply(known) == 1
    view = state.view()
    np.testing.assert_allclose(view.final_poses()[:2, 0], [1.0, 1.5])
    assert np.isnan(view.final_poses()[2]).all()
    assert view.current_pose() is None


def test_landmarks_without_a_finite_position_are_left_out() -> None:
    state = MapState()
    position = np.array([[0, 0, 1], [np.nan, 0, 1], [0, np.inf, 1]])
    state.apply(with_keyframes(landmarks(0, 0, np.arange(3), position), 0))
    assert state.view().clusters[0].landmark_id.tolist() == [0]


def test_a_state_of_another_version_is_undecided_and_a_keyframe_without_a_number_is_nobodys_reference() -> None:
    state = MapState()
    state.add_frame(0, replace(tracked(0, 3), reference_keyframe_id=-1))
    strange = with_keyframes(landmarks(0, 0, np.arange(2), np.ones((2, 3)), state=9), 0, 3)
    state.apply(replace(strange, keyframe_id=np.array([keyframe_id(0), -1])))
    view = state.view()
    assert view.counts_by_state().tolist() == [0, 0, 0, 2, 0]
    assert view.frames.reference_row.tolist() == [-1]
    np.testing.assert_allclose(view.final_poses()[0, :3], [3, 0, 0])


def test_a_landmark_follows_its_anchor_and_is_in_one_cluster_only() -> None:
    state = MapState()
    state.apply(with_keyframes(landmarks(0, 0, np.arange(2), np.ones((2, 3))), 0, 5))
    for anchor in (5, 0, 5):
        state.apply(landmarks(1, anchor, np.array([1]), np.ones(3)))
        view = state.view()
        held = {
            int(number): cluster.landmark_id.tolist()
            for number, cluster in zip(view.keyframes.id, view.clusters, strict=True)
        }
        assert held[keyframe_id(anchor)] == ([0, 1] if anchor == 0 else [1])
        assert sum(len(ids) for ids in held.values()) == 2


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 12))
def test_many_updates_come_to_the_same_as_their_last_word(seed: int, steps: int) -> None:
    rng = np.random.default_rng(seed)
    state, words = MapState(), {}
    state.apply(with_keyframes(MapUpdate(0), *range(4)))
    for step in range(steps):
        ids = rng.choice(20, rng.integers(0, 12), replace=False)
        anchor, kind, number = int(rng.integers(0, 4)), int(rng.integers(0, 5)), int(rng.integers(0, 3))
        removed = rng.choice(20, rng.integers(0, 4), replace=False)
        update = landmarks(step, anchor, ids, rng.normal(size=(len(ids), 3)), state=kind, object_id=number)
        state.apply(replace(update, removed_landmark_id=removed))
        words |= {int(i): (anchor, kind, number, step * FRAME_NS) for i in ids}
        words = {i: word for i, word in words.items() if i not in removed}
        view = state.view()
        held = {
            int(cluster.landmark_id[row]): (
                int(anchor_id - keyframe_id(0)),
                int(cluster.state[row]),
                int(cluster.object_id[row]),
                int(cluster.last_seen_ns[row]),
            )
            for anchor_id, cluster in zip(view.keyframes.id, view.clusters, strict=True)
            for row in range(len(cluster))
        }
        assert held == words
        seen = {
            number: sorted({word[3] for word in words.values() if word[1] == MotionState.MOVING and word[2] == number})
            for number in (1, 2)
        }
        assert {number: view.sightings.get(number, np.empty(0)).tolist() for number in (1, 2)} == seen


def test_bounds_hold_every_landmark() -> None:
    view = view_of(20)
    for centre, radius, pose, cluster in zip(
        view.keyframes.bound_centre, view.keyframes.bound_radius, view.keyframes.pose, view.clusters, strict=True
    ):
        points = cluster.position.astype(float) @ np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]]) + pose[:3]
        assert np.all(np.linalg.norm(points - centre, axis=1) <= radius + 1e-9)


def test_removing_what_is_not_there_changes_nothing() -> None:
    assert LandmarkTable().remove(np.array([3, 4])) == (set(), set())


def test_frames_go_into_the_map_that_takes_theirs_over() -> None:
    state = MapState()
    for frame, update in drive(3, every=1):
        state.add_frame(frame.timestamp_ns // FRAME_NS, frame)
        state.apply(update)
    later = with_keyframes(MapUpdate(3 * FRAME_NS, map_id=2), 3)
    state.add_frame(3, replace(tracked(3, 3), map_id=2))
    state.apply(replace(later, keyframe_map_id=np.array([2])))
    assert state.view().frame_map_ids().tolist() == [1, 1, 1, 2]
    assert len(trajectory_tum(state.view(), 1).splitlines()) == 1 + 3
    state.apply(with_keyframes(MapUpdate(4 * FRAME_NS, map_id=1), 3, y=7.0))
    view = state.view()
    assert view.frame_map_ids().tolist() == [1, 1, 1, 1]
    assert view.final_poses()[3, :2].tolist() == [3.0, 7.0]
    assert len(trajectory_tum(view, 1).splitlines()) == 1 + 4


def test_a_frame_without_a_known_keyframe_stays_in_the_map_it_was_reported_in() -> None:
    state = MapState()
    state.add_frame(0, replace(tracked(0, 3), map_id=4))
    assert state.view().frame_map_ids().tolist() == [4]
