# SPDX-License-Identifier: Apache-2.0
"""Middlebury's optical flow, .flo: the tag `PIEH`, width and height as int32, then u and v as float32, row by row.

Source: Baker et al., "A Database and Evaluation Methodology for Optical Flow", IJCV 2011, and its flow-code.
"""

from pathlib import Path

import numpy as np

from services.formats.kitti_flow import FlowImage
from services.runtime.errors import InputError

UNKNOWN_PX = 1e9
"""A flow beyond this is unknown."""
_TAG = b"PIEH"
_HEADER = 12
_EXPECTED = "Middlebury flow (.flo)"


def read_middlebury_flow(path: Path) -> FlowImage:
    """Read one image. Raises InputError for another tag or a length that does not fit width and height."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}), expected {_EXPECTED}") from None
    if data[:4] != _TAG:
        raise InputError(f"{path}: begins with {data[:4]!r}, expected {_TAG!r} as {_EXPECTED} does")
    width, height = (int(value) for value in np.frombuffer(data[4:_HEADER].ljust(8, b"\0"), dtype="<i4"))
    needed = _HEADER + 8 * width * height
    if width <= 0 or height <= 0 or len(data) != needed:
        raise InputError(f"{path}: {width}x{height} px in {len(data)} bytes, expected {needed} bytes")
    flow = np.frombuffer(data, dtype="<f4", offset=_HEADER).reshape(height, width, 2).astype(np.float32)
    valid = np.all(np.abs(flow) < UNKNOWN_PX, axis=2)
    flow[~valid] = 0.0
    return FlowImage(flow, valid)


def write_middlebury_flow(path: Path, image: FlowImage) -> None:
    """Write one image; what is not valid becomes a flow of 10^10 px, which the format calls unknown."""
    height, width = image.valid.shape
    flow = np.where(image.valid[..., None], image.flow, 1e10).astype("<f4")
    path.write_bytes(_TAG + np.array([width, height], dtype="<i4").tobytes() + flow.tobytes())
