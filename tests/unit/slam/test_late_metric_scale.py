# SPDX-License-Identifier: Apache-2.0
"""A depth sensor that sees little of the first frames makes the map metric later, and for all of its past."""

import numpy as np
import numpy.typing as npt
import pytest

from schemas.records.camera import CameraCalibration, DepthImage, Image
from schemas.records.slam import MapUpdate, MaskSource, TrackedFrame
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
    scales = {number: pose[7] for number, (_, pose) in poses.items()}
    assert len({scales[number] for number in known_before}) == 1, "one scale for all that was mapped in units"
    assert all(scale == 1 for number, scale in scales.items() if number not in known_before)
    live, last = frames[-1].map_from_camera, frames[-1].covariance
    assert live is not None
    assert last is not None
    assert np.linalg.norm(live[:3] - ORIGIN) == pytest.approx((25 * FRAME_NS - times_ns[0]) / FRAME_NS * 0.4, rel=0.05)


def test_a_map_without_any_depth_stays_in_units(room: TexturedRoom) -> None:
    frames, updates = drive(room, blind_frames=25)
    assert not any(frame.metric_scale for frame in frames)
    assert all((update.keyframe_pose[:, 7] == 1.0).all() for update in updates)


def keyframes(updates: list[MapUpdate]) -> dict[int, tuple[int, npt.NDArray[np.float64]]]:
    """Keyframe -> its time and its newest pose."""
    return {
        int(number): (int(time_ns), pose)
        for update in updates
        for number, time_ns, pose in zip(
            update.keyframe_id, update.keyframe_timestamp_ns, update.keyframe_pose, strict=True
        )
    }
