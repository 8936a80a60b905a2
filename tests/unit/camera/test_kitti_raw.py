# SPDX-License-Identifier: Apache-2.0
"""KITTI's raw drives and tracking sequences: times, pairs, true poses from the inertial unit."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from services.camera.sources.folders.image_files import list_images
from services.camera.sources.kitti.oxts import imu_poses
from services.camera.sources.kitti.raw import KittiRaw, drives_in, is_kitti_drive
from services.camera.sources.kitti.tracking import KittiTracking, is_tracking_sequence, sequences_in
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError

SIZE = (32, 24)
P2 = "20 0 16 2 0 20 12 0 0 0 1 0"
P3 = "20 0 16 -8 0 20 12 0 0 0 1 0"
# Camera: x right, y down, z forward; velodyne and unit: x forward, y left, z up; the unit 0.8 m behind the velodyne.
VELO_TO_CAM = "0 -1 0 0 0 -1 1 0 0"
EARTH_RADIUS_M = 6378137.0
LATITUDE = 49.0


def _oxts(east_m: float, north_m: float, up_m: float, yaw: float) -> str:
    """A row for a place in metres from (49 N, 8 E), small enough that the sphere is a plane."""
    latitude = LATITUDE + np.degrees(north_m / EARTH_RADIUS_M)
    longitude = 8.0 + np.degrees(east_m / EARTH_RADIUS_M / np.cos(np.radians(LATITUDE)))
    return f"{latitude:.12f} {longitude:.12f} {100 + up_m} 0 0 {yaw} " + "0 " * 24


# Two metres ahead to the north-east, then turned left by 90 degrees.
DIAGONAL = np.pi / 4
ROWS = (
    _oxts(0, 0, 0, DIAGONAL),
    _oxts(2 * np.cos(DIAGONAL), 2 * np.sin(DIAGONAL), 0.5, DIAGONAL),
    _oxts(2 * np.cos(DIAGONAL), 2 * np.sin(DIAGONAL), 0.5, DIAGONAL + np.pi / 2),
)


def _images(folder: Path, digits: int, offset: int = 0) -> None:
    folder.mkdir(parents=True)
    for index in range(3):
        cv2.imwrite(str(folder / f"{index:0{digits}d}.png"), np.full((*SIZE[::-1], 3), 10 * index + offset, np.uint8))


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    date = tmp_path / "2011_09_26"
    folder = date / "2011_09_26_drive_0001_sync"
    for camera in (2, 3):
        _images(folder / f"image_0{camera}" / "data", 10, camera)
        times = "".join(f"2011-09-26 13:02:2{5 + index}.{964389445 + index}\n" for index in range(3))
        (folder / f"image_0{camera}" / "timestamps.txt").write_text(times)
    (folder / "oxts/data").mkdir(parents=True)
    for index, row in enumerate(ROWS):
        (folder / f"oxts/data/{index:010d}.txt").write_text(row + "\n")
    (date / "calib_cam_to_cam.txt").write_text(
        "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\n"
        f"S_rect_02: 3.2e+01 2.4e+01\nR_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_00: 20 0 16 0 0 20 12 0 0 0 1 0\n"
        f"P_rect_02: {P2}\nP_rect_03: {P3}\n"
    )
    (date / "calib_velo_to_cam.txt").write_text(f"calib_time: 15-Mar-2012\nR: {VELO_TO_CAM}\nT: 0 -0.1 -0.3\n")
    (date / "calib_imu_to_velo.txt").write_text("R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0 0\n")
    return folder


@pytest.fixture
def tracking(tmp_path: Path) -> Path:
    split = tmp_path / "training"
    _images(split / "image_02/0000", 6)
    _images(split / "image_03/0000", 6)
    (split / "calib").mkdir()
    (split / "oxts").mkdir()
    (split / "calib/0000.txt").write_text(
        f"P0: 20 0 16 0 0 20 12 0 0 0 1 0\nP1: {P3}\nP2: {P2}\nP3: {P3}\nR_rect 1 0 0 0 1 0 0 0 1\n"
        "Tr_velo_cam 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3\nTr_imu_velo 1 0 0 -0.8 0 1 0 0 0 0 1 0\n"
    )
    (split / "oxts/0000.txt").write_text("\n".join(ROWS) + "\n")
    return split / "image_02/0000"


def _frame(source: KittiRaw | KittiTracking, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def _check_truth(source: KittiRaw | KittiTracking) -> None:
    """Against the drive by hand: the world is rectified camera 0 at the start, the camera sits 0.1 m left of it."""
    poses = [pose.world_from_camera for index in range(3) if (pose := _frame(source, index).true_pose) is not None]
    np.testing.assert_allclose(poses[0][:3, 3], (-0.1, 0, 0), atol=1e-9)
    np.testing.assert_allclose(poses[0][:3, :3], np.eye(3), atol=1e-9)
    np.testing.assert_allclose(poses[1][:3, 3], (-0.1, -0.5, 2.0), atol=1e-6)
    # Turned left about the unit, which sits 0.8 + 0.3 m behind camera 0: what was ahead of it is now to its left (-x).
    np.testing.assert_allclose(poses[2][:3, 2], (-1, 0, 0), atol=1e-9)
    seen_from_unit = np.array((-0.1, 0.0, 1.1))
    turned = np.array((-1.1, 0.0, -0.1))
    np.testing.assert_allclose(poses[2][:3, 3] - poses[1][:3, 3], turned - seen_from_unit, atol=1e-6)


def test_a_drive_gives_its_pairs_times_and_truth(drive: Path) -> None:
    assert is_kitti_drive(drive)
    assert drives_in(drive.parent) == [drive]
    source = KittiRaw(drive)
    assert (source.frame_count, source.notes) == (3, ())
    frame = _frame(source, 1)
    # 2011-09-26 13:02:26 UTC is 1317042146 s.
    assert (frame.name, frame.timestamp_ns) == ("0000000001", 1_317_042_146_964_389_446)
    assert frame.image.pixels[0, 0].tolist() == [12, 12, 12]
    assert frame.image_right is not None
    assert frame.image_right.pixels[0, 0].tolist() == [13, 13, 13]
    assert frame.calibration_right is not None
    assert frame.calibration_right.projection is not None
    assert frame.calibration_right.projection[0, 3] == -10
    assert _frame(KittiRaw(drive, stereo=False), 0).image_right is None
    _check_truth(source)


def test_a_part_of_a_drive_keeps_its_numbers(drive: Path) -> None:
    for camera in (2, 3):
        (drive / f"image_0{camera}/data/0000000000.png").unlink()
    source = KittiRaw(drive)
    assert source.frame_count == 2
    frame = _frame(source, 0)
    assert (frame.name, frame.timestamp_ns) == ("0000000001", 1_317_042_146_964_389_446)
    assert frame.true_pose is not None
    np.testing.assert_allclose(frame.true_pose.world_from_camera[:3, 3], (-0.1, 0, 0), atol=1e-9)


def test_without_extrinsics_it_says_that_there_is_no_truth(drive: Path) -> None:
    (drive.parent / "calib_imu_to_velo.txt").unlink()
    source = KittiRaw(drive)
    assert _frame(source, 0).true_pose is None
    assert "no true pose: no calib_imu_to_velo.txt" in source.notes


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("image_02/timestamps.txt", "2011-09-26 13:02:25.1\n", "1 times, expected one for image 0000000002"),
        ("image_02/timestamps.txt", "1.0\n2.0\n3.0\n", r"line 1: '1\.0', expected such as 2011-09-26 13:02:25"),
        ("image_02/timestamps.txt", "2011-13-26 13:02:25\n" * 3, r"line 1: '2011-13-26 13:02:25', expected such as"),
        ("image_02/timestamps.txt", "2011-09-26 13:02:25.5\n" * 3, "line 2: time .* expected times that increase"),
        (
            "image_02/timestamps.txt",
            "1969-12-31 23:59:58\n1969-12-31 23:59:59\n1970-01-01 00:00:00\n",
            "line 1: .* expected times that increase from 1970",
        ),
        (
            "../calib_velo_to_cam.txt",
            "R: 0 0 0 0 0 0 0 0 0\nT: 0 0 0\n",
            r"calib_velo_to_cam\.txt line 1: R is no rotation, expected one",
        ),
        ("oxts/data/0000000001.txt", "49 8 100\n", r"0000000001\.txt line 1: 3 numbers, expected 30"),
        ("oxts/data/0000000001.txt", "", r"0000000001\.txt: 0 lines, expected one"),
        ("oxts/data/0000000001.txt", "90 " * 30, r"latitude 90, expected one between -90 and 90 degrees"),
        ("../calib_velo_to_cam.txt", "T: 0 0 0\n", r"calib_velo_to_cam\.txt: no line 'R'"),
        ("../calib_imu_to_velo.txt", "R: 1 0 0\nT: 0 0 0\n", r"calib_imu_to_velo\.txt line 1: 3 numbers, expected 9"),
        ("../calib_cam_to_cam.txt", f"P_rect_02: {P2}\nP_rect_03: {P3}\n", r"no line 'S_rect_02', expected one with 2"),
        (
            "../calib_cam_to_cam.txt",
            f"P_rect_02: {P2}\nP_rect_03: {P3}\nS_rect_02: 40 30\n",
            r"image_02: images of 32x24 px, expected the 40x30 px of .* a drive named _sync",
        ),
        ("../calib_cam_to_cam.txt", "S_rect_00: 32 24\n", r"calib_cam_to_cam\.txt: no projection matrix"),
    ],
)
def test_bad_files_of_a_drive_are_named(drive: Path, name: str, text: str, said: str) -> None:
    (drive / name).write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        KittiRaw(drive)
    assert "\n" not in str(caught.value)


def test_a_tracking_sequence_finds_its_files_two_folders_up(tracking: Path) -> None:
    assert is_tracking_sequence(tracking)
    assert sequences_in(tracking.parent.parent) == [tracking]
    source = KittiTracking(tracking)
    assert (source.name, source.frame_count) == ("KITTI tracking training 0000", 3)
    frame = _frame(source, 2)
    assert (frame.name, frame.timestamp_ns) == ("000002", 200_000_000)
    assert frame.image_right is not None
    assert source.notes == ("KITTI tracking gives no times: they are assumed at 10 Hz",)
    assert _frame(KittiTracking(tracking, rate_hz=5), 2).timestamp_ns == 400_000_000
    _check_truth(source)


def test_bad_files_of_a_tracking_sequence_are_named(tracking: Path) -> None:
    oxts = tracking.parent.parent / "oxts/0000.txt"
    oxts.write_text("\n".join(ROWS[:2]))
    with pytest.raises(InputError, match=r"0000\.txt: 2 lines, expected 3, one for every image"):
        KittiTracking(tracking)
    oxts.unlink()
    assert "no true pose: no oxts/0000.txt" in KittiTracking(tracking).notes
    (tracking.parent.parent / "calib/0000.txt").unlink()
    with pytest.raises(InputError, match=r"calib/0000\.txt: no such file, expected KITTI's calib\.txt"):
        KittiTracking(tracking)


def test_a_right_camera_with_fewer_images_is_named(tracking: Path) -> None:
    right = tracking.parent.parent / "image_03/0000"
    list_images(right)[0].unlink()
    with pytest.raises(InputError, match=r"image_03/0000: no 000000, expected one for every image in .*image_02/0000"):
        KittiTracking(tracking)


def test_poses_of_the_unit_start_at_the_identity() -> None:
    rows = np.array([[49.0, 8.0, 100.0, 0.1, -0.2, 0.3], [49.0, 8.00001, 101.0, 0.1, -0.2, 0.8]])
    poses = imu_poses(rows)
    np.testing.assert_allclose(poses[0], np.eye(4), atol=1e-9)
    moved_m = np.linalg.norm(poses[1][:3, 3])
    assert moved_m == pytest.approx(np.hypot(np.cos(np.radians(49)) * EARTH_RADIUS_M * np.radians(1e-5), 1.0))


def test_a_tracking_sequence_that_lacks_an_image_keeps_the_times_and_truth_of_the_others(tracking: Path) -> None:
    whole = KittiTracking(tracking)
    for camera in ("image_02", "image_03"):
        (tracking.parent.parent / camera / "0000/000001.png").unlink()
    frame, expected = _frame(KittiTracking(tracking), 1), _frame(whole, 2)
    assert frame.timestamp_ns == expected.timestamp_ns == 200_000_000
    assert frame.true_pose is not None
    assert expected.true_pose is not None
    np.testing.assert_array_equal(frame.true_pose.world_from_camera, expected.true_pose.world_from_camera)
