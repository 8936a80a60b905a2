# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import cv2
import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import CameraCalibration, DepthImage, TrueInstances, TrueObject, TruePose
from services.evaluation.map.session_surface import session_surface
from services.evaluation.map.surface import BackProjection, SurfaceOptions, thinned
from services.formats.point_cloud import LabelledPoints
from services.runtime.errors import InputError
from services.runtime.session_file import RecordedMessage

mcap_writer = pytest.importorskip("services.recorder.session_writer")
K = np.array([[40.0, 0.0, 31.5], [0.0, 40.0, 23.5], [0.0, 0.0, 1.0]])
HEIGHT, WIDTH = 48, 64
STATIC, NON_MOVING, MOVING = 0, 1, 2


def _calibration(*distortion: float) -> CameraCalibration:
    return CameraCalibration(0, WIDTH, HEIGHT, K, distortion)


def _wall(time_ns: int = 0, distance_m: float = 8.0) -> DepthImage:
    return DepthImage(time_ns, np.full((HEIGHT, WIDTH), distance_m, np.float32))


def _truth(time_ns: int = 0) -> TrueInstances:
    """A parked car (3) on the left, one that drives (5) on the right."""
    labels = np.zeros((HEIGHT, WIDTH), np.uint32)
    labels[20:30, 5:15], labels[20:30, 45:55] = 3, 5
    box = (0.0, 0.0, 10.0, 10.0)
    return TrueInstances(
        time_ns,
        labels,
        (TrueObject(3, "car", False, (0, 0, 0), (0, 0, 0), box), TrueObject(5, "car", True, (3, 0, 0), (0, 0, 0), box)),
    )


def _pose(x: float = 0.0) -> TruePose:
    """Looks along world x, y left, z up, 1.5 m above the ground."""
    pose = np.eye(4)
    pose[:3, :3] = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    pose[:3, 3] = (x, 0.0, 1.5)
    return TruePose(0, pose)


EVERYWHERE = np.ones((HEIGHT, WIDTH), dtype=bool)


def test_pixels_come_to_lie_where_they_were_seen() -> None:
    points = BackProjection(_calibration()).points(_wall(), _pose(2.0), _truth(), EVERYWHERE)
    np.testing.assert_allclose(points.position[:, 0], 10.0)
    corner = (10.0, 8.0 * 31.5 / 40, 1.5 + 8.0 * 23.5 / 40)  # the upper left pixel is left of us and above
    np.testing.assert_allclose(points.position[0], corner, atol=1e-6)
    states = points.state.reshape(HEIGHT, WIDTH)
    assert (states[25, 10], states[25, 50], states[0, 0]) == (NON_MOVING, MOVING, STATIC)


def test_a_distorted_pixel_is_brought_back() -> None:
    calibration = _calibration(-0.2, 0.05, 0.001, -0.002, 0.0)
    points = BackProjection(calibration).points(_wall(), TruePose(0, np.eye(4)), _truth(), EVERYWHERE)
    back, _ = cv2.projectPoints(points.position, np.zeros(3), np.zeros(3), K, np.array(calibration.distortion))
    rows, columns = np.nonzero(EVERYWHERE)
    np.testing.assert_allclose(back[:, 0], np.stack((columns, rows), axis=1), atol=0.05)


def test_images_of_other_sizes_are_refused() -> None:
    depth = DepthImage(7, np.ones((4, 4), np.float32))
    with pytest.raises(InputError, match=r"depth of \(4, 4\) and labels of \(48, 64\) at 7 ns, expected \(48, 64\)"):
        BackProjection(_calibration()).points(depth, _pose(), _truth(), EVERYWHERE)


def test_thinning_keeps_one_point_of_every_state_in_a_voxel() -> None:
    position = np.array([(0.01, 0, 0), (0.02, 0, 0), (0.03, 0, 0), (-0.01, 0, 0), (5.0, 0, 0)])
    cloud = LabelledPoints(position, np.array([0, 0, 1, 0, 0], np.uint8))
    thin = thinned([cloud, cloud], 0.1)
    np.testing.assert_array_equal(thin.position[:, 0], [0.01, 0.03, -0.01, 5.0])
    assert thin.state.tolist() == [0, 1, 0, 0]
    assert len(thinned([], 0.1)) == 0


def _session(path: Path, frames: int = 5, without: str = "") -> Path:
    messages = []
    for number in range(frames):
        records = [
            (topics.CALIBRATION, _calibration()),
            (topics.DEPTH, _wall(number)),
            (topics.TRUE_POSE, _pose(float(number))),
            (topics.TRUE_INSTANCES, _truth(number)),
        ]
        messages += [
            RecordedMessage(topic.key, number, number, encode(topic, record))
            for topic, record in records
            if topic.key != without
        ]
    writer = mcap_writer.SessionWriter(path, "wall")
    writer.append(messages)
    writer.finish()
    writer.close()
    return path


def test_what_moves_is_taken_in_every_frame_and_what_stands_in_some(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    session = _session(tmp_path / "a.mcap")
    surface = session_surface(session, SurfaceOptions(3, 0.1), on_frame=lambda done, all_: told.append((done, all_)))
    assert told == [(1, 5), (2, 5), (3, 5), (4, 5), (5, 5)]
    assert sorted(set(surface.position[surface.state != MOVING, 0].tolist())) == [8.0, 11.0]
    assert sorted(set(surface.position[surface.state == MOVING, 0].tolist())) == [8.0, 9.0, 10.0, 11.0, 12.0]


def test_what_is_missing_is_one_clear_line(tmp_path: Path) -> None:
    for number, topic in enumerate((topics.DEPTH, topics.TRUE_INSTANCES, topics.CALIBRATION)):
        session = _session(tmp_path / f"{number}.mcap", without=topic.key)
        with pytest.raises(InputError, match=f"no {topic.key} in it, expected --surface, or a run with true depth"):
            session_surface(session)
    with pytest.raises(InputError, match="nothing within 2 m of the camera"):
        session_surface(_session(tmp_path / "far.mcap"), SurfaceOptions(farthest_m=2.0))
    with pytest.raises(InputError, match="voxel nan m, expected a number above 0"):
        SurfaceOptions(voxel_m=float("nan"))
