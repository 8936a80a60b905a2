# SPDX-License-Identifier: Apache-2.0
"""Folders of images: order, size, and what is wrong with a file is said by name."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from services.camera.sources.folders.image_files import ImageFiles, list_images
from services.camera.sources.folders.image_header import read_image_size
from services.runtime.errors import InputError


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(1, 300), st.integers(1, 300), st.booleans(), st.sampled_from([".png", ".jpg"]))
def test_head_tells_the_size_that_decoding_gives(
    tmp_path: Path, width: int, height: int, grey: bool, suffix: str
) -> None:
    path = tmp_path / f"any{suffix}"
    cv2.imwrite(str(path), np.zeros((height, width) if grey else (height, width, 3), dtype=np.uint8))
    assert read_image_size(path) == (width, height)


def test_progressive_jpeg_with_a_comment_is_read(tmp_path: Path) -> None:
    path = tmp_path / "progressive.jpg"
    cv2.imwrite(str(path), np.zeros((40, 50, 3), dtype=np.uint8), [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])
    data = path.read_bytes()
    path.write_bytes(data[:2] + b"\xff\xfe\x00\x06hey!" + data[2:])
    assert read_image_size(path) == (50, 40)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from([b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"\xff\xd8\xff\xe0\x00\x02"]), st.binary(max_size=60))
def test_any_bytes_give_a_size_or_one_line(tmp_path: Path, head: bytes, rest: bytes) -> None:
    path = tmp_path / "any.png"
    path.write_bytes(head + rest)
    try:
        width, height = read_image_size(path)
    except InputError as error:
        assert str(path) in str(error)
        assert "\n" not in str(error)
    else:
        assert width > 0
        assert height > 0


def test_order_counts_numbers_as_numbers(tmp_path: Path) -> None:
    names = ["frame10.png", "frame2.png", "frame1.PNG", "b.jpeg", "notes.txt", ".hidden.png"]
    for name in names:
        (tmp_path / name).touch()
    assert [path.name for path in list_images(tmp_path)] == ["b.jpeg", "frame1.PNG", "frame2.png", "frame10.png"]


def test_images_keep_their_channels_and_lose_their_depth(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    colour = rng.integers(0, 256, (8, 9, 3), dtype=np.uint8)
    cv2.imwrite(str(tmp_path / "0.png"), colour)
    cv2.imwrite(str(tmp_path / "1.png"), np.full((8, 9), 513, dtype=np.uint16))
    images = ImageFiles(tmp_path)
    np.testing.assert_array_equal(images.read(0), colour)
    assert images.read(1).shape == (8, 9)
    assert images.read(1).dtype == np.uint8
    assert (images.read(1) == 2).all()


def test_another_size_in_the_middle_is_found_at_once(make_images: Callable[..., Path]) -> None:
    folder = make_images("images", 5)
    cv2.imwrite(str(folder / "000003.png"), np.zeros((24, 33), dtype=np.uint8))
    with pytest.raises(InputError, match=r"000003\.png: 33x24 px, expected 32x24 as in 000000\.png"):
        ImageFiles(folder)


def test_a_file_that_is_no_image_is_found_at_once(make_images: Callable[..., Path]) -> None:
    folder = make_images("images", 3)
    (folder / "000001.png").write_text("not an image")
    with pytest.raises(InputError, match=r"000001\.png: not a readable image"):
        ImageFiles(folder)


@pytest.mark.parametrize("suffix", [".png", ".jpg"])
def test_a_cut_off_image_is_named_when_it_is_read(make_images: Callable[..., Path], suffix: str) -> None:
    folder = make_images("images", 2, suffix=suffix, size=(320, 240))
    path = folder / f"000001{suffix}"
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    images = ImageFiles(folder)
    assert images.read(0).shape == (240, 320)
    with pytest.raises(InputError, match=r"000001.*not a readable image, expected a whole PNG or JPEG file"):
        images.read(1)


def test_an_image_that_vanished_or_changed_is_named(make_images: Callable[..., Path]) -> None:
    folder = make_images("images", 3)
    images = ImageFiles(folder)
    (folder / "000001.png").unlink()
    cv2.imwrite(str(folder / "000002.png"), np.zeros((10, 10), dtype=np.uint8))
    with pytest.raises(InputError, match=r"000001\.png: cannot be read"):
        images.read(1)
    with pytest.raises(InputError, match=r"000002\.png: 10x10 px, expected 32x24"):
        images.read(2)


def test_no_folder_and_no_images(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        ImageFiles(tmp_path / "missing")
    with pytest.raises(InputError, match=r"no images, expected files ending in \.png"):
        ImageFiles(tmp_path)
