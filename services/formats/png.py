# SPDX-License-Identifier: Apache-2.0
"""PNG files that hold numbers rather than colours: read and written without any conversion."""

import struct
import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_AROUND_CHUNK = 12
"""Bytes of a chunk beside its data: length, kind and checksum."""


def read_png(path: Path, expected: str) -> npt.NDArray[Any]:
    """The pixels as they are stored: (H, W) or (H, W, channels), 8 or 16 bits, colours in the order R, G, B.

    Raises:
        InputError: no such file or no whole PNG; names the file and says what was `expected`.
    """
    try:
        data = path.read_bytes()
        pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_UNCHANGED) if _is_whole(data) else None
    except FileNotFoundError:
        raise InputError(f"{path}: no such file, expected {expected}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}), expected {expected}") from None
    except ValueError:  # a name with a character that no file's can have
        raise InputError(f"{str(path)!r}: no name of a file, expected {expected}") from None
    except cv2.error:
        pixels = None
    if pixels is None:
        raise InputError(f"{path}: not a whole PNG file, expected {expected}")
    return pixels[..., ::-1] if pixels.ndim == 3 and pixels.shape[2] == 3 else pixels


def write_png(path: Path, pixels: npt.NDArray[Any]) -> None:
    """Write (H, W) or (H, W, 3) in the order R, G, B, uint8 or uint16."""
    ordered = np.ascontiguousarray(pixels[..., ::-1]) if pixels.ndim == 3 else pixels
    _, data = cv2.imencode(".png", ordered)
    path.write_bytes(data.tobytes())


def _is_whole(data: bytes) -> bool:
    """Whether every chunk is there and as its checksum says; libpng would write to standard error where one is not."""
    place = len(_SIGNATURE)
    if data[:place] != _SIGNATURE:
        return False
    while place + _AROUND_CHUNK <= len(data):
        length, kind = struct.unpack_from(">I4s", data, place)
        end = place + _AROUND_CHUNK + length
        if end > len(data) or zlib.crc32(data[place + 4 : end - 4]) != struct.unpack_from(">I", data, end - 4)[0]:
            return False
        if kind == b"IEND":
            return True
        place = end
    return False


def described(pixels: npt.NDArray[Any]) -> str:
    """Size, channels and bits in words, for an error message."""
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    kind = "" if channels == 1 else " (colours or a palette)"
    size = f"{pixels.shape[1]}x{pixels.shape[0]} px"
    return f"{size} of {channels} channel{'s'[: channels > 1]}{kind} of {8 * pixels.dtype.itemsize} bits"
