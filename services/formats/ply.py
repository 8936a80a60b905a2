# SPDX-License-Identifier: Apache-2.0
"""Point clouds as PLY: the vertices of an ascii or binary file, every property a scalar."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.formats.point_table import header_lines, table_of
from services.runtime.errors import InputError

_TYPES = {
    **{"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2"},
    **{"uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4"},
    **{"double": "f8", "float64": "f8"},
}
_BYTE_ORDER = {"ascii": "<", "binary_little_endian": "<", "binary_big_endian": ">"}


def parse_ply(path: Path, data: bytes) -> npt.NDArray[np.void]:
    """The vertices as one structured row each; other elements behind them are left out.

    Raises InputError naming the line of the header that cannot be used.
    """
    lines, begin = header_lines(path, data, "end_header", "PLY")
    if lines[0] != ["ply"]:
        raise InputError(f"{path}: begins with '{' '.join(lines[0])[:20]}', expected ply")
    encoding = next((words[1] for words in lines if words[0] == "format" and len(words) > 1), "")
    if encoding not in _BYTE_ORDER:
        raise InputError(f"{path}: format '{encoding}', expected one of {', '.join(_BYTE_ORDER)}")
    elements = [number for number, words in enumerate(lines) if words[0] == "element"]
    if not elements or lines[elements[0]][1:2] != ["vertex"]:
        raise InputError(f"{path}: its first element is no vertex, expected a point cloud")
    count = lines[elements[0]][2:]
    if len(count) != 1 or not count[0].isdecimal():
        raise InputError(f"{path}: element vertex {' '.join(count)}, expected a number of vertices")
    behind = elements[1] if len(elements) > 1 else len(lines)
    properties = [words for words in lines[elements[0] + 1 : behind] if words[0] == "property"]
    fields = [_field(path, words, _BYTE_ORDER[encoding]) for words in properties]
    if not fields or len({name for name, _ in fields}) < len(fields):
        raise InputError(f"{path}: the vertices have no properties or one twice, expected x, y, z and others")
    return table_of(path, data[begin:], np.dtype(fields), int(count[0]), ascii_rows=encoding == "ascii")


def _field(path: Path, words: list[str], byte_order: str) -> tuple[str, str]:
    if len(words) != 3 or words[1] not in _TYPES:
        raise InputError(f"{path}: '{' '.join(words)}', expected a scalar property: a type and a name")
    return words[2], byte_order + _TYPES[words[1]]
