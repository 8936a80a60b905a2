# SPDX-License-Identifier: Apache-2.0
"""Every file of a data set read back by the project's own readers, and by others', against the drive itself."""

import contextlib
import hashlib
import io
import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from schemas.categories import category_id
from schemas.records import MotionState
from services.camera.sources.folders.depth_files import DepthFiles
from services.camera.sources.kitti.odometry import KittiOdometry
from services.formats.coco import read_coco
from services.formats.kitti_flow import read_kitti_flow
from services.formats.kitti_poses import read_kitti_poses
from services.formats.kitti_tracking import TrackedBox, read_kitti_tracking
from services.formats.label_images import read_label_image, read_label_index
from services.formats.mots import CAR, IGNORED, PERSON, read_mots_text
from services.formats.png import read_png
from services.formats.point_cloud import read_points
from services.formats.rle import decode_mask
from services.formats.tum import read_tum
from services.simulator.data_sets.frame_writer import MOVING, NOBODY, NON_MOVING
from services.simulator.data_sets.request import parse_formats
from services.simulator.data_sets.surface import FARTHEST_M
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame
from tests.unit.simulator.data_set_drive import TINY, make, tiny_request

pytest.importorskip("pycocotools")


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data_set") / "tiny"
    assert make(folder, tiny_request()) == [("00", index) for index in range(TINY.frames)]
    return folder


@pytest.fixture(scope="module")
def drive() -> Drive:
    return Drive(TINY)


@pytest.fixture(scope="module")
def frames(drive: Drive) -> list[SimulatedFrame]:
    """The truth; it shows something that moves and something that stands."""
    frames = [drive.render(index) for index in range(TINY.frames)]
    states = {item.moving for frame in frames for item in frame.instances if item.visible_px > 20}
    assert states == {True, False}
    return frames


def _sequence(root: Path) -> Path:
    return root / "sequences" / "00"


def test_the_projects_own_kitti_reader_gives_the_drive(root: Path, drive: Drive, frames: list[SimulatedFrame]) -> None:
    source = KittiOdometry(_sequence(root))
    assert source.frame_count == len(frames)
    assert source.rate_hz == pytest.approx(TINY.rate_hz)
    world_from_first = frames[0].world_from_camera
    for frame in frames:
        read = source.frame(frame.index)
        assert read is not None
        assert read.timestamp_ns == frame.timestamp_ns
        assert np.array_equal(read.image.pixels, frame.image)
        assert np.allclose(read.calibration.intrinsics, drive.camera.k, rtol=1e-12)
        assert read.true_pose is not None
        assert np.allclose(world_from_first @ read.true_pose.world_from_camera, frame.world_from_camera, atol=1e-8)


def test_calibration_is_kittis(root: Path, drive: Drive) -> None:
    lines = (_sequence(root) / "calib.txt").read_text().splitlines()
    rows = {name: np.array(numbers.split(), float).reshape(3, 4) for name, numbers in (x.split(": ") for x in lines)}
    assert list(rows) == ["P0", "P1", "P2", "P3", "Tr"]
    for name in ("P0", "P1", "P2", "P3"):
        assert np.allclose(rows[name][:, :3], drive.camera.k, rtol=1e-12)
        assert (rows[name][:, 3] == 0.0).all()


def test_grey_images_are_the_colour_images(root: Path, frames: list[SimulatedFrame]) -> None:
    for frame in frames:
        grey = read_png(_sequence(root) / f"image_0/{frame.index:06d}.png", "a grey image")
        assert np.array_equal(grey, cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY))


def test_trajectories_are_the_same_in_both_formats(root: Path, frames: list[SimulatedFrame]) -> None:
    tum = read_tum(_sequence(root) / "trajectory.tum")
    kitti = read_kitti_poses(root / "poses" / "00.txt", _sequence(root) / "times.txt")
    assert tum.timestamp_ns.tolist() == [frame.timestamp_ns for frame in frames]
    assert np.array_equal(tum.timestamp_ns, kitti.timestamp_ns)
    assert np.allclose(tum.world_from_camera, kitti.world_from_camera, atol=1e-8)
    assert np.allclose(kitti.world_from_camera[0], np.eye(4), atol=1e-9)
    assert tum.length_m > 5.0


def test_depth_is_true_to_half_a_step(root: Path, frames: list[SimulatedFrame]) -> None:
    paths = [_sequence(root) / f"depth/{frame.index:06d}.png" for frame in frames]
    depths = DepthFiles(paths, (TINY.width, TINY.height), 256.0)
    for frame in frames:
        read = depths.read(frame.index)
        near = (frame.depth_m > 0.0) & (frame.depth_m < 65535 / 256)
        assert near.any()
        assert np.abs(read - frame.depth_m)[near].max() <= 0.5 / 256 + 1e-5
        assert (read[frame.depth_m == 0.0] == 0.0).all()
        assert (read[frame.depth_m > 256.0] == 0.0).all()


def test_flow_is_true_to_a_64th_of_a_pixel(root: Path, drive: Drive) -> None:
    for index in range(TINY.frames - 1):
        read = read_kitti_flow(_sequence(root) / f"flow/{index:06d}.png")
        truth = drive.flow(index)
        known = truth.visible & (np.abs(truth.flow_px) < 511.0).all(axis=2)
        assert known.mean() > 0.3
        assert np.array_equal(read.valid, known)
        assert np.abs(read.flow - truth.flow_px)[known].max() <= 1 / 64
    assert not (_sequence(root) / f"flow/{TINY.frames - 1:06d}.png").exists()


def test_label_images_and_moving_masks_are_exact(root: Path, frames: list[SimulatedFrame]) -> None:
    index = read_label_index(_sequence(root) / "instances")
    assert list(index) == [f"{frame.index:06d}" for frame in frames]
    for frame in frames:
        name = f"{frame.index:06d}"
        assert np.array_equal(read_label_image(_sequence(root) / f"instances/{name}.png"), frame.labels)
        rows = [(item.label, item.category, item.moving) for item in index[name]]
        assert rows == [(item.instance_id, item.category, item.moving) for item in frame.instances]
        mask = read_png(_sequence(root) / f"moving/{name}.png", "a moving mask")
        moving = [item.instance_id for item in frame.instances if item.moving]
        assert np.array_equal(mask == MOVING, np.isin(frame.labels, moving))
        assert np.array_equal(mask == NOBODY, frame.labels == 0)
        assert set(np.unique(mask)) <= {NOBODY, NON_MOVING, MOVING}


def test_coco_masks_are_exact_and_pycocotools_takes_the_file(root: Path, frames: list[SimulatedFrame]) -> None:
    path = root / "annotations" / "instances.json"
    dataset = read_coco(path)
    by_image = {image.image_id: image for image in dataset.images}
    assert [(root / image.file_name).is_file() for image in dataset.images] == [True] * TINY.frames
    expected = [(frame, item) for frame in frames for item in frame.instances]
    assert len(dataset.annotations) == len(expected)
    for annotation, (frame, item) in zip(dataset.annotations, expected, strict=True):
        assert by_image[annotation.image_id].file_name.endswith(f"image_2/{frame.index:06d}.png")
        assert np.array_equal(decode_mask(annotation.mask), frame.labels == item.instance_id)
        assert annotation.category_id == category_id(item.category)
        assert annotation.box_px == item.box_px
        assert annotation.attributes == {"track_id": item.instance_id, "moving": item.moving}
        assert not annotation.is_crowd
    from pycocotools.coco import COCO

    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO(str(path))
    mask = coco.annToMask(coco.anns[1])
    assert np.array_equal(mask, frames[0].labels == expected[0][1].instance_id)


def test_mots_masks_are_exact_and_ids_last(root: Path, frames: list[SimulatedFrame]) -> None:
    objects = read_mots_text(root / "instances_txt" / "00.txt")
    number_of: dict[int, int] = {}
    for found in objects:
        frame = frames[found.frame]
        mask = decode_mask(found.mask)
        if found.class_id == IGNORED:
            continue
        ids = np.unique(frame.labels[mask])
        assert len(ids) == 1
        assert np.array_equal(mask, frame.labels == ids[0])
        item = next(item for item in frame.instances if item.instance_id == ids[0])
        assert found.class_id == {"car": CAR, "person": PERSON}[item.category]
        assert number_of.setdefault(found.object_id, item.instance_id) == item.instance_id
    assert len(set(number_of.values())) == len(number_of)
    seen = sum(item.category in ("car", "person") for frame in frames for item in frame.instances)
    assert sum(found.class_id != IGNORED for found in objects) == seen


def _corners_px(box: TrackedBox, k: np.ndarray) -> np.ndarray:
    """Image of the cuboid's corners as KITTI's devkit computes them, (8, 2)."""
    height, width, length = box.size_m
    x = 0.5 * length * np.array([1, 1, -1, -1, 1, 1, -1, -1])
    z = 0.5 * width * np.array([1, -1, -1, 1, 1, -1, -1, 1])
    y = -height * np.array([0, 0, 0, 0, 1, 1, 1, 1])
    cos, sin = np.cos(box.rotation_y), np.sin(box.rotation_y)
    corners = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]) @ [x, y, z] + np.array(box.place_m)[:, None]
    image = k @ corners
    return (image[:2] / image[2]).T


def test_tracking_labels_hold_the_mask_and_lie_in_their_cuboids_image(
    root: Path, drive: Drive, frames: list[SimulatedFrame]
) -> None:
    boxes = read_kitti_tracking(root / "label_02" / "00.txt")
    assert {(box.frame, box.object_id) for box in boxes} == {
        (frame.index, item.instance_id) for frame in frames for item in frame.instances
    }
    compared = 0
    for box in boxes:
        frame = frames[box.frame]
        item = next(item for item in frame.instances if item.instance_id == box.object_id)
        left, top, right, bottom = box.box_px
        x, y, width, height = item.box_px
        assert left <= x
        assert top <= y
        assert right >= x + width - 1
        assert bottom >= y + height - 1
        assert box.category == {"car": "Car", "person": "Pedestrian"}[item.category]
        assert box.size_m == pytest.approx((item.size_m[2], item.size_m[1], item.size_m[0]), abs=1e-5)
        assert box.alpha == pytest.approx(
            np.angle(np.exp(1j * (box.rotation_y - np.arctan2(box.place_m[0], box.place_m[2])))), abs=1e-5
        )
        if box.place_m[2] - 0.5 * np.hypot(*box.size_m[1:]) < 1.0:
            continue
        corners = _corners_px(box, drive.camera.k)
        slack = 2.5
        assert (corners.min(axis=0) - slack <= (left, top)).all()
        assert (corners.max(axis=0) + slack >= (right, bottom)).all()
        compared += 1
    assert compared > 5


def test_surface_points_lie_where_the_depth_image_says(root: Path, drive: Drive, frames: list[SimulatedFrame]) -> None:
    points = read_points(root / "surface" / "00.ply")
    first = frames[0]
    places = drive.camera.project(points.position)
    columns, rows = np.rint(places).astype(int).T
    assert np.abs(places - np.rint(places)).max() < 1e-2
    assert np.allclose(first.depth_m[rows, columns], points.position[:, 2], atol=1e-3)
    assert points.position[:, 2].max() <= FARTHEST_M + 1e-3
    moving = [item.instance_id for item in first.instances if item.moving]
    assert not np.isin(first.labels[rows, columns], moving).any()
    standing = first.labels[rows, columns] > 0
    assert np.array_equal(standing, points.state == MotionState.NON_MOVING)
    assert (points.state[~standing] == MotionState.STATIC).all()
    assert len(points) > 500


def test_the_folder_says_what_it_is_and_can_be_checked(root: Path) -> None:
    readme = (root / "README.txt").read_text()
    for part in ("image_2", "calib.txt", "instances", "flow", "moving", "depth", "label_02", "MOTS", "surface", "tum"):
        assert part in readme
    assert max(map(len, readme.splitlines())) <= 140
    sums = (root / "SHA256SUMS").read_text()
    listed = dict(reversed(line.split("  ")) for line in sums.splitlines())
    there = {str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()}
    assert there == set(listed) | {"SHA256SUMS", "dataset.json"}
    for name, digest in listed.items():
        assert hashlib.sha256((root / name).read_bytes()).hexdigest() == digest
    manifest = json.loads((root / "dataset.json").read_text())
    assert manifest["complete"] is True
    assert manifest["files"]["count"] == len(listed)
    assert manifest["files"]["sha256"] == hashlib.sha256(sums.encode()).hexdigest()
    assert manifest["options"]["seeds"] == [3]


def test_a_stereo_data_set_is_read_as_a_rectified_pair(tmp_path: Path) -> None:
    stereo = replace(TINY, frames=1, stereo_baseline_m=0.54)
    make(tmp_path, tiny_request(drive=stereo, formats=parse_formats(["grey"])))
    drive = Drive(stereo)
    truth = drive.render(0)
    for left in ("image_2", "image_0"):
        read = KittiOdometry(tmp_path / "sequences" / "00", left=left).frame(0)
        assert read is not None
        assert read.image_right is not None
        assert read.calibration_right is not None
        assert read.calibration_right.projection is not None
        assert read.calibration_right.projection[0, 3] == pytest.approx(-drive.camera.fx_px * 0.54)
        right = truth.image_right if left == "image_2" else cv2.cvtColor(truth.image_right, cv2.COLOR_BGR2GRAY)
        assert np.array_equal(read.image_right.pixels, right)
        assert not np.array_equal(read.image_right.pixels, read.image.pixels)
