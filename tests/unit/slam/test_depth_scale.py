# SPDX-License-Identifier: Apache-2.0
"""A depth sensor that sees little of the first frames makes the map metric later, and for all of its past."""

import numpy as np
import numpy.typing as npt
import pytest

from schemas.records.camera import CameraCalibration, DepthImage, Image
from schemas.records.slam import MapUpdate, MaskSource, TrackedFrame, TrackingState
from services.slam.depth_scale import DepthScale
from services.slam.engine_adapter import EngineSettings, SlamEngine
from tests.unit.slam.textured_room import TexturedRoom

FRAME_NS = 100_000_000
ORIGIN = np.array([1.0, 2.0, 1.65])


@pytest.fixture(scope="module")
def room() -> TexturedRoom:
    return TexturedRoom(seed=3)


def drive(room: TexturedRoom, blind_frames: int) -> tuple[list[TrackedFrame], list[MapUpdate]]:
    """25 frames, the depth images of the first ones empty."""
    first_camera = np.concatenate((ORIGIN, (-0.5, 0.5, -0.5, 0.5)))
    calibration = CameraCalibration(0, room.width, room.height, room.intrinsics)
    engine = SlamEngine(calibration, EngineSettings(map_from_first_camera=first_camera))
    frames, updates = [], []
    for index in range(25):
        time_ns = (index + 1) * FRAME_NS
        pixels, depth_m = room.render(index)
        depth = DepthImage(time_ns, np.zeros_like(depth_m) if index < blind_frames else depth_m)
        engine.begin_frame(Image(time_ns, pixels), depth=depth)
        frames.append(engine.finish_frame(None, MaskSource.NO_MASKS))
        updates.append(engine.take_map_update(time_ns))
    engine.flush()
    updates.append(engine.take_map_update(25 * FRAME_NS))
    return frames, updates


def test_a_map_becomes_metric_when_depth_comes_within_reach(room: TexturedRoom) -> None:
    frames, updates = drive(room, blind_frames=8)
    metric = [frame.metric_scale for frame in frames]
    assert not any(metric[:9])
    assert metric == sorted(metric)
    first = metric.index(True)
    assert [update.metric_scale for update in updates] == [*metric, True]
    poses = keyframes(updates)
    known_before = keyframes(updates[:first])
    assert set(known_before) <= set(updates[first].keyframe_id.tolist()), "all that were sent in units are due again"
    times_ns, positions = zip(*(poses[number] for number in sorted(poses)), strict=True)
    travelled_m = np.linalg.norm(np.array(positions)[:, :3] - ORIGIN, axis=1)
    assert travelled_m == pytest.approx((np.array(times_ns) - times_ns[0]) / FRAME_NS * room.step_m, rel=0.05, abs=1e-9)
    assert np.ptp(np.array(positions)[:, 7]) == 0, "one scale for the whole map"
    live, last = frames[-1].map_from_camera, frames[-1].covariance
    assert live is not None
    assert last is not None
    assert np.linalg.norm(live[:3] - ORIGIN) == pytest.approx((25 * FRAME_NS - times_ns[0]) / FRAME_NS * 0.4, rel=0.05)


def test_a_map_without_any_depth_stays_in_units(room: TexturedRoom) -> None:
    frames, updates = drive(room, blind_frames=25)
    assert not any(frame.metric_scale for frame in frames)
    assert all((update.keyframe_pose[:, 7] == 1.0).all() for update in updates)


@pytest.mark.parametrize(("landmarks", "expected"), [(29, False), (30, True)])
def test_a_few_landmarks_say_nothing(landmarks: int, expected: bool) -> None:
    scale = DepthScale(CameraCalibration(0, 64, 48, np.array([[50.0, 0, 32], [0, 50, 24], [0, 0, 1]])), np.zeros(3))
    pose = np.array([0.0, 0, 0, 0, 0, 0, 1])
    update = MapUpdate(
        1,
        keyframe_id=np.array([0]),
        keyframe_timestamp_ns=np.array([1]),
        keyframe_map_id=np.array([0]),
        keyframe_pose=np.append(pose, 1.0)[None],
        keyframe_culled=np.zeros(1, np.uint8),
        keyframe_parent_id=np.array([-1]),
        landmark_id=np.arange(landmarks),
        landmark_anchor_id=np.zeros(landmarks, np.int64),
        landmark_position=np.tile(np.array([0.0, 0.0, 2.0], np.float32), (landmarks, 1)),
        landmark_state=np.zeros(landmarks, np.uint8),
        landmark_last_seen_ns=np.ones(landmarks, np.int64),
    )
    state, ahead = TrackingState.TRACKING, np.array([4.0, 0, 0, 0, 0, 0, 1])
    frame = TrackedFrame(2, state, "", 0, ahead, np.eye(6), 0, pose, 9, 9, False, MaskSource.NO_MASKS, False, "base")
    scale.update(update)
    scale.look(update, pose, DepthImage(1, np.full((48, 64), 6.0, np.float32)))
    found = scale.frame(frame)
    assert found.metric_scale is expected
    if expected:
        assert found.map_from_camera is not None
        assert found.covariance is not None
        assert found.map_from_camera[:3].tolist() == [12.0, 0.0, 0.0]
        assert np.diag(found.covariance).tolist() == [9.0, 9.0, 9.0, 1.0, 1.0, 1.0]
        assert found.camera_from_reference is pose


def keyframes(updates: list[MapUpdate]) -> dict[int, tuple[int, npt.NDArray[np.float64]]]:
    """Keyframe -> its time and its newest pose."""
    return {
        int(number): (int(time_ns), pose)
        for update in updates
        for number, time_ns, pose in zip(
            update.keyframe_id, update.keyframe_timestamp_ns, update.keyframe_pose, strict=True
        )
    }
