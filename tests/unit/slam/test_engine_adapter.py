# SPDX-License-Identifier: Apache-2.0
"""The engine through its adapter: what it refuses, and what it makes of a street seen from a moving camera."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from schemas.records.camera import CameraCalibration, DepthImage, Image
from schemas.records.objects import MotionState, Objects, ObjectTrack
from schemas.records.slam import MapUpdate, MaskSource, TrackedFrame, TrackingState
from services.runtime.errors import InputError
from services.slam.engine_adapter import EngineSettings, SlamEngine
from tests.unit.slam.textured_room import TexturedRoom

FRAME_NS = 100_000_000


def calibration(room: TexturedRoom) -> CameraCalibration:
    return CameraCalibration(0, room.width, room.height, room.intrinsics)


def objects_in(room: TexturedRoom, timestamp_ns: int, state: MotionState) -> Objects:
    """One object over a patch of the left part of the image."""
    track_image = np.zeros((room.height, room.width), np.uint32)
    track_image[60:180, 40:200] = 7
    row = ObjectTrack(7, "car", 0.9, state, 0.5, (40, 60, 200, 180), 1)
    return Objects(timestamp_ns, track_image, (row,))


def drive(
    engine: SlamEngine, room: TexturedRoom, frames: int, state: MotionState | None = None, *, with_depth: bool = False
) -> tuple[list[TrackedFrame], list[MapUpdate]]:
    tracked, updates = [], []
    for index in range(frames):
        timestamp_ns = (index + 1) * FRAME_NS
        pixels, depth_m = room.render(index)
        objects = None if state is None else objects_in(room, timestamp_ns, state)
        engine.begin_frame(Image(timestamp_ns, pixels), depth=DepthImage(timestamp_ns, depth_m) if with_depth else None)
        masks = MaskSource.NO_MASKS if objects is None else MaskSource.FRESH
        tracked.append(engine.finish_frame(objects, masks))
        updates.append(engine.take_map_update(timestamp_ns))
    engine.flush()
    updates.append(engine.take_map_update(frames * FRAME_NS))
    return tracked, updates


def landmark_states(updates: list[MapUpdate]) -> dict[int, tuple[int, int]]:
    """Landmark -> (state, object id), removed ones left out."""
    states: dict[int, tuple[int, int]] = {}
    for update in updates:
        rows = zip(update.landmark_id, update.landmark_state, update.landmark_object_id, strict=True)
        states.update({int(number): (int(state), int(owner)) for number, state, owner in rows})
        for number in update.removed_landmark_id:
            del states[int(number)]
    return states


def keyframe_poses(updates: list[MapUpdate]) -> dict[int, npt.NDArray[np.float64]]:
    return {
        int(number): pose
        for update in updates
        for number, pose in zip(update.keyframe_id, update.keyframe_pose, strict=True)
    }


@pytest.fixture(scope="module")
def room() -> TexturedRoom:
    return TexturedRoom(seed=3)


def test_follows_a_camera_with_metric_scale_when_depth_is_given(room: TexturedRoom) -> None:
    tracked, updates = drive(SlamEngine(calibration(room)), room, 25, with_depth=True)
    assert tracked[-1].state is TrackingState.TRACKING
    assert tracked[-1].metric_scale
    poses = keyframe_poses(updates)
    last = max(poses)
    travelled_m = np.linalg.norm(poses[last][:3] - poses[min(poses)][:3])
    newest_ns = {
        int(number): int(time)
        for update in updates
        for number, time in zip(update.keyframe_id, update.keyframe_timestamp_ns, strict=True)
    }
    frames_between = (newest_ns[last] - newest_ns[min(poses)]) / FRAME_NS
    assert travelled_m == pytest.approx(frames_between * room.step_m, rel=0.05)


def test_the_first_camera_looks_along_x_in_a_map_with_z_up(room: TexturedRoom) -> None:
    tracked, _ = drive(SlamEngine(calibration(room)), room, 20)
    pose = tracked[-1].map_from_camera
    assert pose is not None
    forward, left, up = pose[:3]
    assert forward > 0
    assert abs(left) < 0.1 * forward
    assert abs(up) < 0.1 * forward


def test_every_frame_gets_a_pose_also_those_before_the_map(room: TexturedRoom) -> None:
    tracked, updates = drive(SlamEngine(calibration(room)), room, 20)
    late = {int(time) for update in updates for time in update.frame_timestamp_ns}
    direct = {frame.timestamp_ns for frame in tracked if frame.map_from_camera is not None}
    assert not late & direct
    assert late | direct == {(index + 1) * FRAME_NS for index in range(20)}


def test_the_same_input_gives_the_same_bytes(room: TexturedRoom) -> None:
    digests = []
    for _ in range(2):
        tracked, updates = drive(SlamEngine(calibration(room)), room, 15, MotionState.NON_MOVING)
        poses = [frame.map_from_camera.tobytes() for frame in tracked if frame.map_from_camera is not None]
        digests.append((poses, [u.landmark_position.tobytes() + u.keyframe_pose.tobytes() for u in updates]))
    assert digests[0] == digests[1]


@pytest.mark.parametrize(
    ("stage", "motion", "labels"),
    [
        ("base", MotionState.MOVING, {(MotionState.STATIC, 0)}),
        ("dynamic", MotionState.NON_MOVING, {(MotionState.STATIC, 0), (MotionState.POTENTIALLY_DYNAMIC, 7)}),
        ("moving", MotionState.NON_MOVING, {(MotionState.STATIC, 0), (MotionState.NON_MOVING, 7)}),
        ("moving", MotionState.UNDECIDED, {(MotionState.STATIC, 0), (MotionState.UNDECIDED, 7)}),
        ("moving", MotionState.MOVING, {(MotionState.STATIC, 0)}),
    ],
)
def test_each_stage_labels_what_it_maps(
    room: TexturedRoom, stage: str, motion: MotionState, labels: set[tuple[MotionState, int]]
) -> None:
    settings = EngineSettings(stage=stage)  # type: ignore[arg-type]
    _, updates = drive(SlamEngine(calibration(room), settings), room, 20, motion)
    assert set(landmark_states(updates).values()) == labels


def test_moving_landmarks_are_placed_by_depth_and_counted_without_it(room: TexturedRoom) -> None:
    _, updates = drive(SlamEngine(calibration(room)), room, 20, MotionState.MOVING, with_depth=True)
    assert (MotionState.MOVING, 7) in set(landmark_states(updates).values())
    tracked, _ = drive(SlamEngine(calibration(room)), room, 20, MotionState.MOVING)
    assert sum(frame.moving_unplaced for frame in tracked) > 0


def test_an_object_that_starts_moving_ends_its_landmarks_but_keeps_them(room: TexturedRoom) -> None:
    engine = SlamEngine(calibration(room))
    _, before = drive(engine, room, 20, MotionState.NON_MOVING)
    standing = {number for number, label in landmark_states(before).items() if label == (MotionState.NON_MOVING, 7)}
    assert standing
    start_ns = 21 * FRAME_NS
    engine.begin_frame(Image(start_ns, room.render(20)[0]))
    engine.finish_frame(objects_in(room, start_ns, MotionState.MOVING), MaskSource.FRESH)
    update = engine.take_map_update(start_ns)
    ended = update.landmark_id[update.landmark_valid_until_ns == start_ns]
    assert set(ended.tolist()) == standing
    assert not set(update.removed_landmark_id.tolist()) & standing


def test_masks_that_are_carried_keep_every_object_out_of_tracking(room: TexturedRoom) -> None:
    engine = SlamEngine(calibration(room))
    for index in range(20):
        timestamp_ns = (index + 1) * FRAME_NS
        engine.begin_frame(Image(timestamp_ns, room.render(index)[0]))
        engine.finish_frame(objects_in(room, timestamp_ns, MotionState.NON_MOVING), MaskSource.CARRIED)
    states = set(landmark_states([engine.take_map_update(0)]).values())
    assert (MotionState.NON_MOVING, 7) not in states


def test_a_blank_image_says_why_it_waits(room: TexturedRoom) -> None:
    engine = SlamEngine(calibration(room))
    engine.begin_frame(Image(1, np.zeros((room.height, room.width), np.uint8)))
    frame = engine.finish_frame(None, MaskSource.NO_MASKS)
    assert frame.state is TrackingState.INITIALIZING
    assert frame.reason == "0 trackable features, 100 needed"
    assert frame.map_from_camera is None


def test_losing_the_camera_keeps_the_map_and_finds_it_again(room: TexturedRoom) -> None:
    engine = SlamEngine(calibration(room))
    _, updates = drive(engine, room, 20)
    mapped = len(landmark_states(updates))
    blank = np.zeros((room.height, room.width), np.uint8)
    for index in range(20, 23):
        engine.begin_frame(Image((index + 1) * FRAME_NS, blank))
        frame = engine.finish_frame(None, MaskSource.NO_MASKS)
        assert frame.state is TrackingState.LOST
        assert frame.reason.startswith("lost: ")
    engine.begin_frame(Image(24 * FRAME_NS, room.render(15)[0]))
    assert engine.finish_frame(None, MaskSource.NO_MASKS).state is TrackingState.TRACKING
    assert len(landmark_states([*updates, engine.take_map_update(24 * FRAME_NS)])) >= mapped


class TestWhatItRefuses:
    def test_an_image_of_another_size(self, room: TexturedRoom) -> None:
        engine = SlamEngine(calibration(room))
        with pytest.raises(InputError, match=f"image: expected {room.width}x{room.height} pixels, got 10x20"):
            engine.begin_frame(Image(1, np.zeros((20, 10), np.uint8)))

    def test_an_image_of_another_type(self, room: TexturedRoom) -> None:
        engine = SlamEngine(calibration(room))
        with pytest.raises(InputError, match=r"image: expected a C-contiguous uint8 array .* got a float32 array"):
            engine.begin_frame(Image(1, np.zeros((room.height, room.width), np.float32)))  # type: ignore[arg-type]

    def test_time_that_runs_backwards(self, room: TexturedRoom) -> None:
        engine = SlamEngine(calibration(room))
        engine.begin_frame(Image(5, room.render(0)[0]))
        engine.finish_frame(None, MaskSource.NO_MASKS)
        with pytest.raises(InputError, match="timestamp_ns: expected one after 5, got 5"):
            engine.begin_frame(Image(5, room.render(0)[0]))

    def test_a_frame_that_was_not_begun(self, room: TexturedRoom) -> None:
        with pytest.raises(RuntimeError, match="finish_frame: no frame was begun"):
            SlamEngine(calibration(room)).finish_frame(None, MaskSource.NO_MASKS)

    @pytest.mark.parametrize(
        ("settings", "message"),
        [
            (EngineSettings(features=3), "features: expected 100 to 20000, got 3"),
            (EngineSettings(pyramid_factor=1.0), "pyramid_factor: expected above 1, at most 2, got 1"),
            (EngineSettings(merge_delay_frames=0), "merge_delay_frames: expected 1 to 1000, got 0"),
            (EngineSettings(map_id=-1), "map_id: expected 0 to 2"),
            (EngineSettings(stage="none"), "stage: expected base, dynamic or moving, got 'none'"),  # type: ignore[arg-type]
        ],
    )
    def test_settings_out_of_range(self, room: TexturedRoom, settings: EngineSettings, message: str) -> None:
        with pytest.raises(InputError, match=message):
            SlamEngine(calibration(room), settings)

    def test_a_right_image_of_a_single_camera(self, room: TexturedRoom) -> None:
        pixels = room.render(0)[0]
        with pytest.raises(InputError, match="right: expected no image of a camera without a stereo baseline"):
            SlamEngine(calibration(room)).begin_frame(Image(1, pixels), Image(1, pixels))

    def test_a_depth_image_of_another_size(self, room: TexturedRoom) -> None:
        depth = DepthImage(1, np.ones((8, 9), np.float32))
        with pytest.raises(InputError, match=f"depth_m: expected {room.width}x{room.height} pixels, got 9x8"):
            SlamEngine(calibration(room)).begin_frame(Image(1, room.render(0)[0]), depth=depth)

    def test_a_lens_that_cannot_be_undone(self, room: TexturedRoom) -> None:
        folded = replace(calibration(room), distortion=(-3.0, 0.0, 0.0, 0.0, 0.0))
        with pytest.raises(InputError, match=r"distortion that can be undone everywhere .* at pixel \(0, 0\)"):
            SlamEngine(folded)

    def test_a_camera_without_a_focal_length(self) -> None:
        with pytest.raises(InputError, match="focal length fx, got 0"):
            SlamEngine(CameraCalibration(0, 640, 480, np.diag([0.0, 500.0, 1.0])))


def test_a_closed_loop_and_a_merged_map_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    room = TexturedRoom(seed=1)
    engine = SlamEngine(calibration(room))
    result_of_frame = engine._engine.finish_frame

    class Recognised:
        loop_closed, maps_merged = True, True

        def __init__(self, *arguments: object) -> None:
            self._result = result_of_frame(*arguments)

        def __getattr__(self, name: str) -> object:
            return getattr(self._result, name)

    engine.begin_frame(Image(1, room.render(0)[0]))
    frame = engine.finish_frame(None, MaskSource.NO_MASKS)
    assert not frame.loop_closed
    assert not frame.maps_merged
    engine.begin_frame(Image(2, room.render(1)[0]))
    monkeypatch.setattr(engine, "_engine", type("Told", (), {"finish_frame": staticmethod(Recognised)}))
    frame = engine.finish_frame(None, MaskSource.NO_MASKS)
    assert frame.loop_closed
    assert frame.maps_merged


def test_without_a_vocabulary_or_with_loop_closing_off_the_engine_runs() -> None:
    room = TexturedRoom(seed=1)
    for settings in (EngineSettings(vocabulary_path=""), EngineSettings(loop_closing=False)):
        tracked, _ = drive(SlamEngine(calibration(room), settings), room, 8)
        assert tracked[-1].state is TrackingState.TRACKING


def test_semi_dense_points_lie_on_the_walls_and_keep_off_what_moves() -> None:
    room = TexturedRoom(seed=3)
    engine = SlamEngine(calibration(room), EngineSettings(semi_dense=True))
    _, updates = drive(engine, room, 24, MotionState.MOVING, with_depth=True)
    frame_of = {
        int(number): int(time_ns) // FRAME_NS - 1
        for update in updates
        for number, time_ns in zip(update.keyframe_id, update.keyframe_timestamp_ns, strict=True)
    }
    landmarks = len(landmark_states(updates))
    errors, points = [], 0
    for update in updates:
        start = 0
        for number, count in zip(update.dense_keyframe_id, update.dense_keyframe_points, strict=True):
            position = update.dense_point_position[start : start + count].astype(np.float64)
            start += count
            pixels = position @ room.intrinsics.T
            column, row = np.rint(pixels[:, :2] / pixels[:, 2:]).astype(int).T
            assert not ((row >= 60) & (row < 180) & (column >= 40) & (column < 200)).any()
            true_m = room.render(frame_of[int(number)])[1][row, column]
            errors.append(position[:, 2] / true_m - 1)
            points += count
        assert start == len(update.dense_point_grey)
    assert points > 2 * landmarks
    assert np.median(np.abs(np.concatenate(errors))) < 0.03


def test_the_first_view_of_a_map_made_from_two_has_semi_dense_points() -> None:
    room = TexturedRoom(seed=3)
    _, updates = drive(SlamEngine(calibration(room), EngineSettings(semi_dense=True)), room, 24)
    first = min(int(number) for update in updates for number in update.keyframe_id)
    points = {
        int(number): int(count)
        for update in updates
        for number, count in zip(update.dense_keyframe_id, update.dense_keyframe_points, strict=True)
    }
    assert points[first] > 300


def test_without_the_option_there_are_no_semi_dense_points() -> None:
    room = TexturedRoom(seed=3)
    _, updates = drive(SlamEngine(calibration(room)), room, 8)
    assert sum(len(update.dense_keyframe_id) for update in updates) == 0
