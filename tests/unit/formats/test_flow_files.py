# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.formats.kitti_flow import FlowImage, read_kitti_flow, write_kitti_flow
from services.formats.middlebury_flow import read_middlebury_flow, write_middlebury_flow
from services.runtime.errors import InputError


@pytest.fixture
def image() -> FlowImage:
    random = np.random.default_rng(3)
    flow = random.uniform(-80, 80, (12, 20, 2)).astype(np.float32)
    valid = random.random((12, 20)) < 0.7
    flow[~valid] = 0.0
    return FlowImage(flow, valid)


def test_kitti_keeps_a_sixty_fourth_of_a_pixel(image: FlowImage, tmp_path: Path) -> None:
    write_kitti_flow(tmp_path / "a.png", image)
    read = read_kitti_flow(tmp_path / "a.png")
    np.testing.assert_array_equal(read.valid, image.valid)
    assert np.abs(read.flow - image.flow).max() <= 0.5 / 64


def test_kitti_channels_are_u_v_valid(tmp_path: Path) -> None:
    flow = np.zeros((2, 2, 2), dtype=np.float32)
    flow[0, 1] = (1.5, -2.0)
    write_kitti_flow(tmp_path / "a.png", FlowImage(flow, np.ones((2, 2), dtype=bool)))
    stored = cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(stored[0, 1], [1, 2**15 - 128, 2**15 + 96])  # OpenCV's order: blue, green, red


def test_a_flow_that_kitti_cannot_hold_becomes_invalid(tmp_path: Path) -> None:
    flow = np.zeros((1, 4, 2), dtype=np.float32)
    flow[0, :3, 0] = (600.0, np.nan, -512.0)
    write_kitti_flow(tmp_path / "a.png", FlowImage(flow, np.ones((1, 4), dtype=bool)))
    np.testing.assert_array_equal(read_kitti_flow(tmp_path / "a.png").valid, [[False, False, True, True]])


def test_middlebury_is_exact(image: FlowImage, tmp_path: Path) -> None:
    write_middlebury_flow(tmp_path / "a.flo", image)
    read = read_middlebury_flow(tmp_path / "a.flo")
    np.testing.assert_array_equal(read.valid, image.valid)
    np.testing.assert_array_equal(read.flow, image.flow)
    np.testing.assert_array_equal(cv2.readOpticalFlow(str(tmp_path / "a.flo"))[image.valid], image.flow[image.valid])


def test_what_is_no_flow_is_named(image: FlowImage, tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "grey.png"), np.zeros((4, 4), dtype=np.uint8))
    with pytest.raises(InputError, match=r"grey\.png.*three channels of 16 bits"):
        read_kitti_flow(tmp_path / "grey.png")
    (tmp_path / "cut.png").write_bytes(b"\x89PNG")
    with pytest.raises(InputError, match=r"cut\.png: not a whole PNG file"):
        read_kitti_flow(tmp_path / "cut.png")
    write_middlebury_flow(tmp_path / "a.flo", image)
    (tmp_path / "b.flo").write_bytes((tmp_path / "a.flo").read_bytes()[:-4])
    with pytest.raises(InputError, match=r"20x12 px in 1928 bytes, expected 1932"):
        read_middlebury_flow(tmp_path / "b.flo")
    (tmp_path / "c.flo").write_bytes(b"PIEH")
    with pytest.raises(InputError, match="0x0 px in 4 bytes"):
        read_middlebury_flow(tmp_path / "c.flo")
    (tmp_path / "d.flo").write_bytes(b"")
    with pytest.raises(InputError, match="expected b'PIEH'"):
        read_middlebury_flow(tmp_path / "d.flo")


def test_real_truth_is_read(shared_data: Path, tmp_path: Path) -> None:
    truth = read_kitti_flow(shared_data / "kitti_flow" / "flow_gt.png")
    assert truth.valid.mean() > 0.1
    write_kitti_flow(tmp_path / "a.png", truth)
    again = read_kitti_flow(tmp_path / "a.png")
    np.testing.assert_array_equal(again.flow, truth.flow)
    np.testing.assert_array_equal(again.valid, truth.valid)
