# SPDX-License-Identifier: Apache-2.0
"""Arrays and small vectors on the wire."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt
from google.protobuf.timestamp_pb2 import Timestamp

from schemas.proto.kinemap.label_image_pb2 import LabelImage

MAX_PIXELS = 1 << 28
"""No image is larger; a broken message must not make us reserve the memory it claims."""


def timestamp_of(timestamp_ns: int) -> Timestamp:
    """Nanoseconds as google.protobuf.Timestamp."""
    return Timestamp(seconds=timestamp_ns // 1_000_000_000, nanos=timestamp_ns % 1_000_000_000)


def nanoseconds_of(timestamp: Timestamp) -> int:
    """google.protobuf.Timestamp as nanoseconds."""
    return int(timestamp.seconds) * 1_000_000_000 + int(timestamp.nanos)


def labels_to_message(labels: npt.NDArray[np.integer[Any]]) -> LabelImage:
    """Run-length encode a label image (H, W)."""
    height, width = labels.shape
    flat = np.ascontiguousarray(labels, dtype=np.uint32).ravel()
    if flat.size == 0:
        return LabelImage(width=width, height=height)
    starts = np.concatenate(([0], np.flatnonzero(flat[1:] != flat[:-1]) + 1))
    lengths = np.diff(starts, append=flat.size)
    return LabelImage(width=width, height=height, values=flat[starts].tolist(), lengths=lengths.tolist())


def labels_to_array(message: LabelImage) -> npt.NDArray[np.uint32]:
    """The label image (H, W), uint32. Raises ValueError when the runs do not fill it exactly."""
    values = np.array(message.values, dtype=np.uint32)
    lengths = np.array(message.lengths, dtype=np.int64)
    pixels = message.width * message.height
    if pixels > MAX_PIXELS:
        raise ValueError(
            f"label image of {message.width}x{message.height} pixels, expected at most {MAX_PIXELS} pixels"
        )
    if values.size != lengths.size or lengths.sum() != pixels:
        raise ValueError(
            f"label image runs cover {int(lengths.sum())} pixels with {values.size} values for {lengths.size} runs, "
            f"expected {message.width}x{message.height} pixels"
        )
    return np.repeat(values, lengths).reshape(message.height, message.width)


def bytes_of(array: npt.NDArray[Any], dtype: str) -> bytes:
    """Row-major little-endian bytes."""
    return np.ascontiguousarray(array, dtype=dtype).tobytes()


def array_of(name: str, data: bytes, dtype: str, *columns: int) -> npt.NDArray[Any]:
    """The rows in `data`, each of `columns`. Raises ValueError when they do not come out even."""
    row = np.dtype(dtype).itemsize * int(np.prod(columns, dtype=np.int64))
    if len(data) % row:
        raise ValueError(f"{name} has {len(data)} bytes, expected a multiple of {row}")
    return np.frombuffer(data, dtype=dtype).reshape(-1, *columns)


def vector_of(name: str, values: Iterable[float], size: int) -> npt.NDArray[np.float64]:
    """A vector of exactly `size` numbers. Raises ValueError otherwise."""
    vector = np.array(list(values), dtype=np.float64)
    if vector.size != size:
        raise ValueError(f"{name} has {vector.size} numbers, expected {size}")
    return vector


def box_of(values: Iterable[float]) -> tuple[float, float, float, float]:
    """x, y, width, height in px. Raises ValueError when there are not four."""
    x, y, width, height = vector_of("box_px", values, 4).tolist()
    return x, y, width, height
