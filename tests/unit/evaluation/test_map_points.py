# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from schemas.records import MapUpdate, MotionState
from services.evaluation.map.points import MapPoints


def _keyframes(*rows: tuple[int, int, bool], pose: tuple[float, ...] = (0, 0, 0, 0, 0, 0, 1, 1)) -> MapUpdate:
    """Keyframes of (id, map id, culled), all with one Sim(3) pose."""
    ids, maps, culled = zip(*rows, strict=True)
    return MapUpdate(
        timestamp_ns=0,
        keyframe_id=np.array(ids, np.int64),
        keyframe_timestamp_ns=np.zeros(len(ids), np.int64),
        keyframe_map_id=np.array(maps, np.int64),
        keyframe_pose=np.tile(np.array(pose, np.float64), (len(ids), 1)),
        keyframe_culled=np.array(culled, np.uint8),
        keyframe_parent_id=np.full(len(ids), -1, np.int64),
    )


def _landmarks(*rows: tuple[int, int, MotionState], removed: tuple[int, ...] = ()) -> MapUpdate:
    """Landmarks of (id, anchor keyframe, state), each at (id, 0, 1) in its keyframe."""
    ids, anchors, states = zip(*rows, strict=True) if rows else ((), (), ())
    return MapUpdate(
        timestamp_ns=0,
        landmark_id=np.array(ids, np.int64),
        landmark_anchor_id=np.array(anchors, np.int64),
        landmark_position=np.array([(i, 0, 1) for i in ids], np.float32).reshape(-1, 3),
        landmark_state=np.array(states, np.uint8),
        removed_landmark_id=np.array(removed, np.int64),
    )


def test_the_last_row_of_a_landmark_counts_and_a_removed_one_does_not() -> None:
    points = MapPoints()
    points.add(_keyframes((0, 0, False)))
    points.add(_landmarks((1, 0, MotionState.STATIC), (2, 0, MotionState.UNDECIDED), (3, 0, MotionState.STATIC)))
    points.add(_landmarks((2, 0, MotionState.MOVING), removed=(3, 99)))
    counts = points.counts_by_label()
    assert counts == {"static": 1, "non_moving": 0, "moving": 1, "undecided": 0, "potentially_dynamic": 0}


def test_points_follow_their_keyframe() -> None:
    points = MapPoints()
    points.add(_keyframes((0, 0, False)))
    points.add(_landmarks((2, 0, MotionState.MOVING), (1, 0, MotionState.STATIC)))
    turn = Rotation.from_euler("y", 90, degrees=True).as_quat()
    points.add(_keyframes((0, 0, False), pose=(10.0, 0.0, 0.0, *turn, 2.0)))
    found = points.points(0)
    # map_from_keyframe = scale * rotation * p + translation; the turn takes z to x and x to -z.
    np.testing.assert_array_equal(found.landmark_id, (1, 2))
    np.testing.assert_allclose(found.position, [(12, 0, -2), (12, 0, -4)], atol=1e-9)
    np.testing.assert_array_equal(found.state, (MotionState.STATIC, MotionState.MOVING))


def test_each_map_has_its_own_points_and_culled_keyframes_still_carry_theirs() -> None:
    points = MapPoints()
    points.add(_keyframes((0, 0, True), (1, 0, False), (2, 5, False), (3, 5, False)))
    points.add(_landmarks((1, 0, MotionState.STATIC), (2, 2, MotionState.STATIC)))
    assert (points.keyframes, points.maps) == (3, 2)
    assert points.points(0).landmark_id.tolist() == [1]
    assert points.points(5).landmark_id.tolist() == [2]


def test_an_empty_map() -> None:
    points = MapPoints()
    assert points.points(0).position.shape == (0, 3)
    assert points.counts_by_label()["static"] == pytest.approx(0)
