# SPDX-License-Identifier: Apache-2.0
"""Point clouds as PCD 0.7: ascii or binary, every field a scalar."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.formats.point_table import header_lines, table_of
from services.runtime.errors import InputError

_KINDS = {"F": "f", "U": "u", "I": "i"}
_SIZES = {"F": ("4", "8"), "U": ("1", "2", "4", "8"), "I": ("1", "2", "4", "8")}
_ENCODINGS = ("ascii", "binary")


def parse_pcd(path: Path, data: bytes) -> npt.NDArray[np.void]:
    """The points as one structured row each. Raises InputError naming the line of the header that cannot be used."""
    lines, begin = header_lines(path, data, "DATA", "PCD")
    header = {words[0]: words[1:] for words in lines}
    dtype = _dtype(path, header)
    count = header.get("POINTS", [])
    if len(count) != 1 or not count[0].isdecimal():
        raise InputError(f"{path}: POINTS {' '.join(count)}, expected a number of points")
    encoding = header["DATA"][0] if header["DATA"] else ""
    if encoding not in _ENCODINGS:
        raise InputError(f"{path}: DATA {encoding}, expected {' or '.join(_ENCODINGS)}")
    return table_of(path, data[begin:], dtype, int(count[0]), ascii_rows=encoding == "ascii")


def _dtype(path: Path, header: dict[str, list[str]]) -> np.dtype[np.void]:
    names, sizes, kinds = (header.get(name, []) for name in ("FIELDS", "SIZE", "TYPE"))
    if not names or not len(names) == len(sizes) == len(kinds) or len(set(names)) < len(names):
        raise InputError(f"{path}: FIELDS, SIZE and TYPE do not name as many different fields, expected a PCD header")
    if any(count != "1" for count in header.get("COUNT", [])):
        raise InputError(f"{path}: COUNT {' '.join(header['COUNT'])}, expected 1 for every field")
    fields = []
    for name, size, kind in zip(names, sizes, kinds, strict=True):
        if size not in _SIZES.get(kind, ()):
            raise InputError(f"{path}: field {name} of TYPE {kind} and SIZE {size}, expected a float or an integer")
        fields.append((name, f"<{_KINDS[kind]}{size}"))
    return np.dtype(fields)
