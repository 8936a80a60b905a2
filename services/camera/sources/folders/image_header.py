# SPDX-License-Identifier: Apache-2.0
"""The size of an image from the head of its file, so that a whole folder is checked without decoding it.

Sources: PNG specification (W3C, 2003) 5.2 and 11.2.2; JPEG, ITU-T T.81 annex B.
"""

import struct
from pathlib import Path
from typing import BinaryIO

from services.runtime.errors import InputError

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg")

_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_START = b"\xff\xd8"
_JPEG_STANDALONE_MARKERS = frozenset((0x01, *range(0xD0, 0xD9)))
# Start-of-frame markers hold the size; C4, C8 and CC lie between them and mean other things (T.81 table B.1).
_JPEG_FRAME_MARKERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


def read_image_size(path: Path) -> tuple[int, int]:
    """(width, height) in px as the file's head says.

    Raises:
        InputError: the file cannot be read, or is no whole PNG or JPEG head; names the file.
    """
    try:
        with path.open("rb") as file:
            head = file.read(24)
            if head.startswith(_PNG_SIGNATURE) and head[12:16] == b"IHDR" and len(head) == 24:
                width, height = struct.unpack(">II", head[16:24])
            elif head.startswith(_JPEG_START):
                file.seek(len(_JPEG_START))
                width, height = _read_jpeg_size(file)
            else:
                raise ValueError
    except OSError as error:
        raise InputError(f"image {path}: cannot be read ({error.strerror})") from error
    except (ValueError, struct.error) as error:
        raise InputError(f"image {path}: not a readable image, expected a whole PNG or JPEG file") from error
    if width == 0 or height == 0:
        raise InputError(f"image {path}: {width}x{height} px, expected an image with pixels")
    return width, height


def _read_jpeg_size(file: BinaryIO) -> tuple[int, int]:
    while True:
        prefix, marker = struct.unpack(">BB", file.read(2))
        if prefix != 0xFF:
            raise ValueError
        while marker == 0xFF:
            (marker,) = struct.unpack(">B", file.read(1))
        if marker in _JPEG_STANDALONE_MARKERS:
            continue
        (length,) = struct.unpack(">H", file.read(2))
        if marker in _JPEG_FRAME_MARKERS:
            _, height, width = struct.unpack(">BHH", file.read(5))
            return width, height
        file.seek(length - 2, 1)
