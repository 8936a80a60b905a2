# SPDX-License-Identifier: Apache-2.0
"""PNG files that hold numbers rather than colours: read and written without any conversion."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError


def read_png(path: Path, expected: str) -> npt.NDArray[Any]:
    """The pixels as they are stored: (H, W) or (H, W, channels), 8 or 16 bits, colours in the order R, G, B.

    Raises:
        InputError: no such file or no whole PNG; names the file and says what was `expected`.
    """
    try:
        data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
        pixels = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if data.size else None
    except FileNotFoundError:
        raise InputError(f"{path}: no such file, expected {expected}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}), expected {expected}") from None
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
