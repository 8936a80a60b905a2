# SPDX-License-Identifier: Apache-2.0
"""Image messages of every encoding as pixels."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from services.camera.sources.recordings.message_log import CompressedPixels, RawPixels
from services.camera.sources.recordings.message_pixels import depth_pixels, image_pixels
from services.runtime.errors import InputError

BLUE, GREEN, RED = 10, 120, 230


def _raw(pixels: npt.NDArray[Any], encoding: str, **changed: Any) -> RawPixels:
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(pixels.shape[0], -1)
    given = {"step": rows.shape[1], "data": rows.ravel(), "big_endian": False, **changed}
    return RawPixels("camera", pixels.shape[1], pixels.shape[0], encoding, **given)


def _filled(*values: int) -> npt.NDArray[np.uint8]:
    return np.tile(np.array(values, np.uint8), (8, 12, 1))


def _bayer(pattern: str) -> npt.NDArray[np.uint8]:
    value = {"r": RED, "g": GREEN, "b": BLUE}
    return np.tile(np.array([value[colour] for colour in pattern], np.uint8).reshape(2, 2), (4, 6))


@pytest.mark.parametrize(
    ("pixels", "encoding"),
    [
        (_filled(BLUE, GREEN, RED), "bgr8"),
        (_filled(BLUE, GREEN, RED), "8UC3"),
        (_filled(RED, GREEN, BLUE), "rgb8"),
        (_filled(BLUE, GREEN, RED, 255), "bgra8"),
        (_filled(RED, GREEN, BLUE, 255), "rgba8"),
        *((_bayer(pattern), f"bayer_{pattern}8") for pattern in ("rggb", "bggr", "gbrg", "grbg")),
    ],
)
def test_colours_become_blue_green_red(pixels: npt.NDArray[np.uint8], encoding: str) -> None:
    found = image_pixels(_raw(pixels, encoding), "here")
    assert (found.shape, found.dtype) == ((8, 12, 3), np.uint8)
    np.testing.assert_array_equal(found[2:-2, 2:-2], _filled(BLUE, GREEN, RED)[2:-2, 2:-2])


def test_yuv_becomes_blue_green_red() -> None:
    bgr = _filled(BLUE, GREEN, RED)
    y, u, v = (int(value) for value in cv2.cvtColor(bgr, cv2.COLOR_BGR2YUV)[0, 0])
    for encoding, two_pixels in (("yuv422", (u, y, v, y)), ("yuv422_yuy2", (y, u, y, v))):
        pixels = np.tile(np.array(two_pixels, np.uint8).reshape(1, 2, 2), (8, 6, 1))
        found = image_pixels(_raw(pixels, encoding), "here").astype(int)
        # The conversion has video's range, 16 to 235: the hue tells which byte is which.
        assert found.shape == (8, 12, 3)
        assert found[0, 0, 0] < found[0, 0, 1] < found[0, 0, 2]


def test_grey_stays_grey() -> None:
    ramp = np.arange(96, dtype=np.uint8).reshape(8, 12)
    np.testing.assert_array_equal(image_pixels(_raw(ramp, "mono8"), "here"), ramp)
    np.testing.assert_array_equal(
        image_pixels(_raw((ramp.astype("u2") << 8).astype(">u2"), "mono16", big_endian=True), "here"), ramp
    )
    png = cv2.imencode(".png", ramp)[1].ravel()
    np.testing.assert_array_equal(image_pixels(CompressedPixels("camera", "png", png), "here"), ramp)


def test_depth_is_in_metres() -> None:
    millimetres = np.array([[0, 1500], [65535, 1]], np.uint16)
    expected = np.array([[0, 1.5], [65.535, 0.001]], np.float32)
    np.testing.assert_allclose(depth_pixels(_raw(millimetres, "16UC1"), "here"), expected)
    np.testing.assert_allclose(
        depth_pixels(_raw(millimetres.astype(">u2"), "16UC1", big_endian=True), "here"), expected
    )
    metres = np.array([[np.nan, 1.5], [np.inf, -2.0]], np.float32)
    np.testing.assert_array_equal(depth_pixels(_raw(metres, "32FC1"), "here"), [[0, 1.5], [0, 0]])
    png = cv2.imencode(".png", millimetres)[1].ravel()
    plain = CompressedPixels("camera", "png", png)
    with_head = CompressedPixels("camera", "16UC1; compressedDepth png", np.concatenate((np.zeros(12, np.uint8), png)))
    for message in (plain, with_head):
        np.testing.assert_allclose(depth_pixels(message, "here"), expected)


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (_raw(_filled(1, 2, 3), "nv12"), "here: encoding 'nv12', expected one of mono8"),
        (
            _raw(_filled(1, 2, 3), "bgr8", data=np.zeros(287, np.uint8)),
            "here: 287 bytes in rows of 36, expected 12x8 px",
        ),
        (_raw(_filled(1, 2, 3), "bgr8", step=35), "bytes in rows of 35, expected 12x8 px of bgr8"),
        (_raw(np.zeros((8, 0), np.uint8), "mono8", step=1), "expected 0x8 px"),
        (
            CompressedPixels("camera", "jpeg", np.zeros(9, np.uint8)),
            "format 'jpeg', expected a whole JPEG or PNG image",
        ),
        (
            CompressedPixels("camera", "h264", np.zeros(0, np.uint8)),
            "format 'h264', expected a whole JPEG or PNG image",
        ),
    ],
)
def test_what_is_no_image_is_one_line(message: RawPixels | CompressedPixels, said: str) -> None:
    with pytest.raises(InputError, match=said):
        image_pixels(message, "here")


def test_what_is_no_depth_is_one_line() -> None:
    colour = CompressedPixels("camera", "jpeg", cv2.imencode(".jpg", _filled(1, 2, 3))[1].ravel())
    with pytest.raises(InputError, match="format 'jpeg', expected depth as a PNG of 16 bits"):
        depth_pixels(colour, "here")


@pytest.mark.parametrize(
    ("pixels", "encoding"),
    [
        (_filled(BLUE, GREEN, RED), "bgr16"),
        (_filled(RED, GREEN, BLUE), "rgb16"),
        (_filled(RED, GREEN, BLUE, 255), "rgba16"),
        (_bayer("gbrg"), "bayer_gbrg16"),
    ],
)
@pytest.mark.parametrize("big_endian", [False, True])
def test_colours_of_16_bits_are_scaled_to_8(pixels: npt.NDArray[np.uint8], encoding: str, big_endian: bool) -> None:
    wide = (pixels.astype(np.uint16) << 8 | 77).astype(">u2" if big_endian else "<u2")
    found = image_pixels(_raw(wide, encoding, big_endian=big_endian), "here")
    np.testing.assert_array_equal(found[2:-2, 2:-2], _filled(BLUE, GREEN, RED)[2:-2, 2:-2])


def test_a_mosaic_in_a_png_becomes_colour() -> None:
    png = cv2.imencode(".png", _bayer("grbg"))[1].ravel()
    message = CompressedPixels("camera", "bayer_grbg8; png compressed bayer_grbg8", png)
    np.testing.assert_array_equal(image_pixels(message, "here")[2:-2, 2:-2], _filled(BLUE, GREEN, RED)[2:-2, 2:-2])


def test_half_a_pair_of_pixels_is_one_line() -> None:
    odd = np.zeros((8, 11, 2), np.uint8)
    with pytest.raises(InputError, match="here: 11x8 px of yuv422, expected an image of whole pairs of pixels"):
        image_pixels(_raw(odd, "yuv422"), "here")
