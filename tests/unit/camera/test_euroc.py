# SPDX-License-Identifier: Apache-2.0
"""EuRoC folders: what they give, how a pair is rectified, and what is said of a bad one."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from services.camera.sources.folders.euroc import Euroc, is_euroc_folder
from services.camera.sources.source import SourceFrame
from services.formats.euroc import write_euroc
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

Array = npt.NDArray[np.float64]

WIDTH, HEIGHT = 320, 200
START_NS = 1_403_636_579_763_555_584
STEP_NS = 50_000_000
INTRINSICS = (
    np.array([[200.0, 0, 161], [0, 201.0, 99], [0, 0, 1]]),
    np.array([[198.0, 0, 158], [0, 199.0, 101], [0, 0, 1]]),
)
DISTORTION = (np.array([-0.28, 0.07, 0.0002, 0.00002]), np.array([-0.27, 0.06, -0.0001, 0.00003]))
# Body: x up, y left; the cameras look along the body's z, turned a little against each other.
BODY_FROM_CAMERA = (
    matrix_from_pose(np.array([-0.02, -0.06, 0.01, 0.02, -0.01, 0.7, 0.714])),
    matrix_from_pose(np.array([-0.02, 0.05, 0.01, 0.01, -0.02, 0.7, 0.714])),
)
FARTHER_RIGHT = (BODY_FROM_CAMERA[0] @ matrix_from_pose(np.array([0.5, 0, 0, 0, 0, 0, 1]))).ravel().tolist()
SAME_PLACE = BODY_FROM_CAMERA[1].ravel().tolist()
# One point of the world a frame, in front of the rig.
POINTS_M = ((0.3, 0.1, 3.0), (-0.7, 0.4, 4.0), (0.2, -0.6, 2.5))


def _world_from_body(index: int) -> Array:
    return matrix_from_pose(np.array([0.1 * index, 0.2, 0.0, 0.02 * index, 0.01, 0.0, 1.0]))


def _sensor(camera: int, **changed: str) -> str:
    k = INTRINSICS[camera]
    values = {
        "sensor_type": "camera",
        "comment": "VI-Sensor cam (MT9M034)",
        "T_BS": "\n  cols: 4\n  rows: 4\n  data: ["
        + ",\n         ".join(", ".join(map(repr, row)) for row in BODY_FROM_CAMERA[camera].tolist())
        + "]",
        "rate_hz": "20",
        "resolution": f"[{WIDTH}, {HEIGHT}]",
        "camera_model": "pinhole",
        "intrinsics": f"[{k[0, 0]}, {k[1, 1]}, {k[0, 2]}, {k[1, 2]}] #fu, fv, cu, cv",
        "distortion_model": "radial-tangential",
        "distortion_coefficients": str(DISTORTION[camera].tolist()),
        **changed,
    }
    return "%YAML:1.0\n# General sensor definitions.\n" + "".join(f"{key}: {text}\n" for key, text in values.items())


def _draw_point(camera: int, index: int) -> npt.NDArray[np.uint8]:
    """The image of a white dot where the lens, with its distortion, throws the frame's point."""
    camera_from_world = np.linalg.inv(_world_from_body(index) @ BODY_FROM_CAMERA[camera])
    rotation, _ = cv2.Rodrigues(camera_from_world[:3, :3])
    pixel, _ = cv2.projectPoints(
        np.array([POINTS_M[index]]), rotation, camera_from_world[:3, 3], INTRINSICS[camera], DISTORTION[camera]
    )
    u, v = pixel.ravel()
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    return np.rint(255 * np.exp(-((columns - u) ** 2 + (rows - v) ** 2) / 8)).astype(np.uint8)


@pytest.fixture
def euroc(tmp_path: Path) -> Path:
    root = tmp_path / "MH_01_easy" / "mav0"
    for camera in (0, 1):
        folder = root / f"cam{camera}"
        (folder / "data").mkdir(parents=True)
        (folder / "sensor.yaml").write_text(_sensor(camera))
        times = [START_NS + STEP_NS * index for index in range(3)]
        rows = "".join(f"{time},{time}.png\r\n" for time in times)
        (folder / "data.csv").write_text(f"#timestamp [ns],filename\r\n{rows}")
        for index, time in enumerate(times):
            cv2.imwrite(str(folder / f"data/{time}.png"), _draw_point(camera, index))
    truth = root / "state_groundtruth_estimate0"
    truth.mkdir()
    poses = np.array([_world_from_body(index) for index in range(3)])
    write_euroc(Trajectory(np.array(times, dtype=np.int64), poses), truth / "data.csv")
    return root.parent


def _frame(source: Euroc, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def _centre_of(pixels: npt.NDArray[np.uint8]) -> Array:
    weights = pixels.astype(np.float64)
    rows, columns = np.mgrid[: pixels.shape[0], : pixels.shape[1]]
    return np.array([(columns * weights).sum(), (rows * weights).sum()]) / weights.sum()


def test_one_camera_stays_as_it_is(euroc: Path) -> None:
    assert is_euroc_folder(euroc)
    assert is_euroc_folder(euroc / "mav0")
    source = Euroc(euroc, stereo=False)
    assert (source.name, source.frame_count, source.rate_hz) == ("EuRoC MH_01_easy", 3, 20)
    frame = _frame(source, 2)
    assert (frame.name, frame.timestamp_ns) == (str(START_NS + 2 * STEP_NS), START_NS + 2 * STEP_NS)
    np.testing.assert_array_equal(frame.image.pixels, _draw_point(0, 2))
    np.testing.assert_array_equal(frame.calibration.intrinsics, INTRINSICS[0])
    assert frame.calibration.distortion == (-0.28, 0.07, 0.0002, 0.00002, 0.0)
    assert frame.image_right is None
    assert frame.true_pose is not None
    np.testing.assert_allclose(frame.true_pose.world_from_camera, _world_from_body(2) @ BODY_FROM_CAMERA[0], atol=1e-8)
    assert source.frame(3) is None
    alone = Euroc(euroc, rectify_stereo=False)
    assert _frame(alone, 0).image_right is None
    assert any("cam1 is not used" in note for note in alone.notes)


@pytest.mark.parametrize("index", range(3))
def test_a_rectified_pair_sees_the_world_where_its_calibration_and_true_pose_say(euroc: Path, index: int) -> None:
    frame = _frame(Euroc(euroc / "mav0"), index)
    assert frame.true_pose is not None
    assert frame.image_right is not None
    assert frame.calibration_right is not None
    assert frame.calibration_right.projection is not None
    assert frame.calibration.distortion == ()
    point = np.linalg.inv(frame.true_pose.world_from_camera) @ np.array([*POINTS_M[index], 1.0])
    left = _centre_of(frame.image.pixels)
    projected = frame.calibration.intrinsics @ point[:3]
    np.testing.assert_allclose(left, projected[:2] / projected[2], atol=0.1)
    right = _centre_of(frame.image_right.pixels)
    projected = frame.calibration_right.projection @ point
    np.testing.assert_allclose(right, projected[:2] / projected[2], atol=0.1)
    assert left[1] == pytest.approx(right[1], abs=0.1)
    baseline_m = -frame.calibration_right.projection[0, 3] / frame.calibration.intrinsics[0, 0]
    assert baseline_m == pytest.approx(0.11, abs=1e-6)


def test_frames_of_one_camera_alone_are_left_out_of_a_pair(euroc: Path) -> None:
    listing = euroc / "mav0/cam1/data.csv"
    listing.write_text("\n".join(listing.read_text().splitlines()[:-1]))
    source = Euroc(euroc)
    assert source.frame_count == 2
    assert "1 images of cam0 have none of cam1 and are left out" in source.notes
    listing.write_text("1,1.png\n")
    with pytest.raises(InputError, match="no image of cam0 has one of cam1 at its time"):
        Euroc(euroc)


def test_truth_between_its_samples_and_beyond_them(euroc: Path) -> None:
    path = euroc / "mav0/state_groundtruth_estimate0/data.csv"
    poses = np.array([_world_from_body(0), _world_from_body(1)])
    write_euroc(Trajectory(np.array([START_NS - STEP_NS, START_NS + STEP_NS], dtype=np.int64), poses), path)
    source = Euroc(euroc, stereo=False)
    middle = _frame(source, 0).true_pose
    assert middle is not None
    camera = pose_from_matrix(middle.world_from_camera)
    half = sum(pose_from_matrix(pose @ BODY_FROM_CAMERA[0]) for pose in poses)
    np.testing.assert_allclose(camera[:3], half[:3] / 2, atol=1e-8)
    np.testing.assert_allclose(camera[3:], half[3:] / np.linalg.norm(half[3:]), atol=1e-8)
    assert _frame(source, 2).true_pose is None
    assert any("1 of 3 frames have no true pose" in note for note in source.notes)
    path.unlink()
    assert _frame(Euroc(euroc, stereo=False), 0).true_pose is None


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"T_BS": f"\n  data: {FARTHER_RIGHT}"}, "cam1: at x -0.39., .* m of the left camera, expected right of it"),
        ({"T_BS": f"\n  data: {SAME_PLACE}"}, "cam1: where the left camera is, expected right of it"),
        (
            {"intrinsics": "[0.001, 200, 161, 99]"},
            "a focal length of .* px instead of 0.001; expected",
        ),
        ({"distortion_coefficients": "[-200, 1e9, 50, 3]"}, "cam1: rectified with the left one, a focal length of"),
        ({"rate_hz": "0"}, "rate_hz 0, expected above 0"),
        ({"intrinsics": "[1, 2, 3]"}, r"intrinsics '\[1, 2, 3\]', expected 4 finite numbers"),
        ({"intrinsics": "[1, 2, 3, nan]"}, "intrinsics .* expected 4 finite numbers"),
        ({"intrinsics": "[0, 2, 3, 4]"}, "focal lengths 0 2, expected above 0"),
        ({"distortion_model": "equidistant"}, "distortion_model 'equidistant', expected radial-tangential"),
        ({"camera_model": "omni"}, "camera_model 'omni', expected pinhole"),
        ({"resolution": "[64, 48]"}, r"320x200 px, expected 64x48 as in .*sensor\.yaml"),
        ({"T_BS": "\n  data: [1, 0, 0]"}, "T_BS has 3 numbers, expected 16"),
    ],
)
def test_bad_sensors_are_one_line(euroc: Path, changed: dict[str, str], said: str) -> None:
    (euroc / "mav0/cam0/sensor.yaml").write_text(_sensor(0, **changed))
    with pytest.raises(InputError, match=said) as caught:
        Euroc(euroc)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("cam0/data.csv", "1403,\n", r"data\.csv line 1: '1403,', expected a time in nanoseconds and a file's name"),
        ("cam0/data.csv", "1.5,a.png\n", r"data\.csv line 1: '1\.5,a\.png', expected a time in nanoseconds"),
        ("cam0/data.csv", "5,a.png\n5,b.png\n", r"data\.csv line 2: time 5 ns, expected times that increase"),
        ("cam0/data.csv", "#only a head\n", r"data\.csv: no images listed"),
        ("cam0/data.csv", "5,a.png\n", r"a\.png: cannot be read"),
        ("cam0/sensor.yaml", "rate_hz: 20\n", r"sensor\.yaml: holds no T_BS"),
        ("state_groundtruth_estimate0/data.csv", "1,2,3\n", r"data\.csv:1: 3 numbers, expected 8 or 17"),
    ],
)
def test_bad_files_are_named_by_line(euroc: Path, name: str, text: str, said: str) -> None:
    (euroc / "mav0" / name).write_text(text)
    with pytest.raises(InputError, match=said):
        Euroc(euroc, stereo=False)
