# SPDX-License-Identifier: Apache-2.0
"""A pair of cameras, and a camera with a fisheye lens, through the adapter and the service."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from schemas import topics
from schemas.records import CameraCalibration, DepthImage, Image, MapUpdate, MaskSource, Objects, TrackedFrame
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.errors import InputError
from services.runtime.service import Bundle
from services.slam.engine_adapter import SlamEngine
from services.slam.service import SlamService
from tests.unit.slam.textured_room import TexturedRoom

FRAME_NS = 100_000_000
BASELINE_M = 0.3
FISHEYE = (-0.02, 0.01, -0.004, 0.0005)


@pytest.fixture(scope="module")
def room() -> TexturedRoom:
    return TexturedRoom(seed=3)


def calibrations(room: TexturedRoom) -> tuple[CameraCalibration, CameraCalibration]:
    left = CameraCalibration(0, room.width, room.height, room.intrinsics)
    focal_px = room.intrinsics[0, 0]
    projection = np.hstack([room.intrinsics, np.array([[-focal_px * BASELINE_M], [0], [0]])])
    return left, replace(left, projection=projection, frame_id="camera_right")


def steps_m(frames: list[TrackedFrame]) -> npt.NDArray[np.float64]:
    """(N - 1,) lengths of the way between frames."""
    poses = [frame.map_from_camera for frame in frames]
    assert all(pose is not None for pose in poses)
    return np.linalg.norm(np.diff([pose[:3] for pose in poses if pose is not None], axis=0), axis=1)


def test_a_pair_is_metric_from_its_first_frame_on(room: TexturedRoom) -> None:
    left, right = calibrations(room)
    engine = SlamEngine(left, right=right)
    frames = []
    for index in range(15):
        time_ns = (index + 1) * FRAME_NS
        beside = Image(time_ns, room.render(index, BASELINE_M)[0], "camera_right")
        engine.begin_frame(Image(time_ns, room.render(index)[0]), beside)
        frames.append(engine.finish_frame(None, MaskSource.NO_MASKS))
    assert all(frame.metric_scale for frame in frames)
    assert frames[0].keyframe_inserted
    assert steps_m(frames).mean() == pytest.approx(room.step_m, rel=0.01)


@pytest.mark.parametrize("with_stereo", [True, False])
def test_the_service_uses_the_right_image_that_comes(room: TexturedRoom, with_stereo: bool) -> None:
    service = SlamService(load_config(None, {"slam": {"use_stereo": with_stereo}}))
    left, right = calibrations(room)
    for index in range(4):
        time_ns = (index + 1) * FRAME_NS
        records = {
            topics.IMAGE: Image(time_ns, room.render(index)[0]),
            topics.CALIBRATION: replace(left, timestamp_ns=time_ns),
            topics.IMAGE_RIGHT: Image(time_ns, room.render(index, BASELINE_M)[0], "camera_right"),
            topics.CALIBRATION_RIGHT: replace(right, timestamp_ns=time_ns),
            topics.OBJECTS: Objects(time_ns, np.zeros((room.height, room.width), np.uint32), ()),
        }
        outgoing = {out.topic: out.record for out in service.process(Bundle(Envelope("s", index, time_ns), records))}
        frame: TrackedFrame = outgoing[topics.TRACKED_FRAME]
        update: MapUpdate = outgoing[topics.MAP_UPDATE]
        assert frame.metric_scale is update.metric_scale is with_stereo


def test_a_fisheye_is_followed_and_its_depth_read_where_it_is(room: TexturedRoom) -> None:
    """150 degrees from edge to edge."""
    wide = TexturedRoom(seed=3, width=480, height=300, focal_px=185.0, fisheye=FISHEYE)
    camera = CameraCalibration(
        0, wide.width, wide.height, wide.intrinsics, distortion=FISHEYE, distortion_model="kannala_brandt"
    )
    for with_depth in (False, True):
        engine = SlamEngine(camera)
        frames = []
        for index in range(20):
            time_ns = (index + 1) * FRAME_NS
            pixels, depth_m = wide.render(index)
            engine.begin_frame(Image(time_ns, pixels), depth=DepthImage(time_ns, depth_m) if with_depth else None)
            frames.append(engine.finish_frame(None, MaskSource.NO_MASKS))
        tracked = [frame for frame in frames if frame.map_from_camera is not None]
        assert len(tracked) >= (20 if with_depth else 12)
        steps = steps_m(tracked)
        assert steps.std() < 0.05 * steps.mean()
        assert tracked[-1].metric_scale is with_depth
        if with_depth:
            assert steps.mean() == pytest.approx(wide.step_m, rel=0.02)


class TestWhatIsNoPair:
    def test_lenses_that_differ(self, room: TexturedRoom) -> None:
        left, right = calibrations(room)
        with pytest.raises(InputError, match="right camera: expected the lens and the size of the left one"):
            SlamEngine(left, right=replace(right, width=right.width - 1))

    def test_a_projection_without_baseline(self, room: TexturedRoom) -> None:
        left, right = calibrations(room)
        with pytest.raises(InputError, match="right camera: expected a projection with -fx"):
            SlamEngine(left, right=replace(right, projection=None))
