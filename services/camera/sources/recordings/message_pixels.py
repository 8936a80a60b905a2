# SPDX-License-Identifier: Apache-2.0
"""Image messages as pixels. Encodings: ROS's sensor_msgs/image_encodings.h and foxglove.RawImage."""

from types import MappingProxyType
from typing import Any, Final

import cv2
import numpy as np
import numpy.typing as npt

from services.camera.sources.recordings.message_log import CompressedPixels, RawPixels
from services.runtime.errors import InputError

# bytes a value and values a pixel as they are stored, then OpenCV's conversion to blue-green-red, if any
_COLOURS: Final = MappingProxyType({
    "mono8": (1, 1, None), "8UC1": (1, 1, None), "mono16": (2, 1, None),
    "bgr8": (1, 3, None), "8UC3": (1, 3, None), "rgb8": (1, 3, cv2.COLOR_RGB2BGR),
    "bgra8": (1, 4, cv2.COLOR_BGRA2BGR), "8UC4": (1, 4, cv2.COLOR_BGRA2BGR), "rgba8": (1, 4, cv2.COLOR_RGBA2BGR),
    "bgr16": (2, 3, None), "16UC3": (2, 3, None), "rgb16": (2, 3, cv2.COLOR_RGB2BGR),
    "bgra16": (2, 4, cv2.COLOR_BGRA2BGR), "rgba16": (2, 4, cv2.COLOR_RGBA2BGR),
    "bayer_rggb8": (1, 1, cv2.COLOR_BayerRGGB2BGR), "bayer_bggr8": (1, 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": (1, 1, cv2.COLOR_BayerGBRG2BGR), "bayer_grbg8": (1, 1, cv2.COLOR_BayerGRBG2BGR),
    "bayer_rggb16": (2, 1, cv2.COLOR_BayerRGGB2BGR), "bayer_bggr16": (2, 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg16": (2, 1, cv2.COLOR_BayerGBRG2BGR), "bayer_grbg16": (2, 1, cv2.COLOR_BayerGRBG2BGR),
    "yuv422": (1, 2, cv2.COLOR_YUV2BGR_UYVY), "uyvy": (1, 2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": (1, 2, cv2.COLOR_YUV2BGR_YUY2), "yuyv": (1, 2, cv2.COLOR_YUV2BGR_YUY2),
})  # fmt: skip
_DEPTHS: Final = MappingProxyType({"16UC1": (2, 1, None), "mono16": (2, 1, None), "32FC1": (4, 1, None)})
_DTYPES = {1: "u1", 2: "u2", 4: "f4"}
_LEVELS_PER_METRE = 1000.0
# What compressed_depth_image_transport puts before the PNG.
_DEPTH_HEADER_BYTES = 12


def image_pixels(message: RawPixels | CompressedPixels, where: str) -> npt.NDArray[np.uint8]:
    """(H, W) grey or (H, W, 3) blue-green-red; `where` names the message in errors.

    Raises:
        InputError: an unknown encoding, or bytes that are cut off or no image.
    """
    if isinstance(message, CompressedPixels):
        flags = cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION
        pixels = np.asarray(_decoded(message.data, flags, message.format, where), dtype=np.uint8)
        # `bayer_rggb8; png compressed bayer_rggb8`: the last word is what the file holds.
        held = message.format.split()[-1:]
        mosaic = bool(held) and held[0].startswith("bayer_") and held[0] in _COLOURS and pixels.ndim == 2
        return _converted(pixels, held[0], where) if mosaic else pixels
    rows = _rows(message, _COLOURS, where)
    if rows.dtype.itemsize == 2:
        rows = (rows >> 8).astype(np.uint8)
    return _converted(np.ascontiguousarray(rows), message.encoding, where)


def depth_pixels(message: RawPixels | CompressedPixels, where: str) -> npt.NDArray[np.float32]:
    """(H, W) in metres, 0 where there is none: whole numbers are millimetres (ROS REP-118), floats metres.

    Raises:
        InputError: an encoding that is no depth, or bytes that are cut off or no image.
    """
    if isinstance(message, CompressedPixels):
        data = message.data[_DEPTH_HEADER_BYTES:] if "compressedDepth" in message.format else message.data
        pixels = _decoded(data, cv2.IMREAD_UNCHANGED, message.format, where)
        if pixels.dtype != np.uint16 or pixels.ndim != 2:
            raise InputError(f"{where}: format {message.format!r}, expected depth as a PNG of 16 bits")
    else:
        pixels = _rows(message, _DEPTHS, where)
    depth_m = pixels.astype(np.float32)
    if pixels.dtype.kind == "u":
        return depth_m / np.float32(_LEVELS_PER_METRE)
    depth_m[~(np.isfinite(depth_m) & (depth_m > 0))] = 0.0
    return depth_m


def _converted(pixels: npt.NDArray[np.uint8], encoding: str, where: str) -> npt.NDArray[np.uint8]:
    """Grey stays grey, all else becomes blue-green-red."""
    conversion = _COLOURS[encoding][2]
    if conversion is None:
        return pixels
    try:
        return np.asarray(cv2.cvtColor(pixels, conversion), dtype=np.uint8)
    except cv2.error:
        size = f"{pixels.shape[1]}x{pixels.shape[0]} px"
        raise InputError(f"{where}: {size} of {encoding}, expected an image of whole pairs of pixels") from None


def _rows(message: RawPixels, known: MappingProxyType[str, Any], where: str) -> npt.NDArray[Any]:
    if message.encoding not in known:
        raise InputError(f"{where}: encoding {message.encoding!r}, expected one of {', '.join(known)}")
    size, channels, _ = known[message.encoding]
    width, height, row = message.width, message.height, message.width * channels * size
    step = message.step or row
    if width < 1 or height < 1 or step < row or len(message.data) < step * (height - 1) + row:
        raise InputError(
            f"{where}: {len(message.data)} bytes in rows of {message.step}, expected {width}x{height} px of "
            f"{message.encoding}"
        )
    # The last row may lack the padding of the others.
    padded = np.zeros(step * height, dtype=np.uint8)
    data = message.data[: step * height]
    if len(data) < len(padded):
        padded[: len(data)] = data
        data = padded
    rows = np.ascontiguousarray(data.reshape(height, step)[:, :row])
    pixels = rows.view((">" if message.big_endian else "<") + _DTYPES[size])
    return pixels if channels == 1 else pixels.reshape(height, width, channels)


def _decoded(data: npt.NDArray[np.uint8], flags: int, form: str, where: str) -> npt.NDArray[Any]:
    try:
        pixels = cv2.imdecode(np.ascontiguousarray(data), flags) if data.size else None
    except cv2.error:
        pixels = None
    if pixels is None:
        raise InputError(f"{where}: format {form!r}, expected a whole JPEG or PNG image")
    return np.asarray(pixels)
