# SPDX-License-Identifier: Apache-2.0
"""Changes to a map file that get past its checksum and its lengths: deep into what its sections say."""

import struct
import zlib

import numpy as np
import numpy.typing as npt

_HEADER = struct.Struct("<8sIIQ")
_LENGTH = struct.Struct("<Q")
_NUMBERS = (0, 1, 2, -1, 255, 2**15, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**32 + 1, 3 << 32, 2**62, 2**63 - 1, -(2**63))
_REALS = (0.0, -0.0, 1.0, -1.0, 1e-300, 1e-9, 1e9, 1e300, np.nan, np.inf, -np.inf)
_LARGEST_ID = 2**33

Bytes = npt.NDArray[np.uint8]


def sections_of(data: bytes) -> dict[bytes, bytes]:
    """The sections of a whole map file by their names."""
    sections, at = {}, _HEADER.size
    while at < len(data):
        name, at = _piece(data, at)
        sections[name], at = _piece(data, at)
    return sections


def file_of(sections: dict[bytes, bytes], header: bytes) -> bytes:
    """A map file of these sections, with lengths and checksum that fit; `header` is of any map file."""
    pieces = (piece for section in sections.items() for piece in section)
    body = b"".join(_LENGTH.pack(len(piece)) + piece for piece in pieces)
    magic, version, _, _ = _HEADER.unpack_from(header)
    return _HEADER.pack(magic, version, zlib.crc32(body), len(body)) + body


def _piece(data: bytes, at: int) -> tuple[bytes, int]:
    begin = at + _LENGTH.size
    end = begin + _LENGTH.unpack_from(data, at)[0]
    return data[begin:end], end


def _numbers_in(section: Bytes) -> npt.NDArray[np.int64]:
    """Where something like an id or a count stands: eight bytes of a number from 1 to a few ranges of ids."""
    if len(section) < _LENGTH.size:
        return np.zeros(0, np.int64)
    windows = np.lib.stride_tricks.sliding_window_view(section, _LENGTH.size)
    values = np.ascontiguousarray(windows).view("<u8")[:, 0]
    return np.flatnonzero((values > 0) & (values < _LARGEST_ID))


class MapFileChanger:
    """Files made from one that is sound; the same generator gives the same files."""

    def __init__(self, data: bytes, random: np.random.Generator) -> None:
        self._data = data
        self._random = random
        self._sections = sections_of(data)
        self._names = list(self._sections)
        arrays = {name: np.frombuffer(piece, np.uint8) for name, piece in self._sections.items()}
        self._numbers = {name: _numbers_in(array) for name, array in arrays.items()}

    def next(self) -> bytes:
        """A file with one to four changes in its sections; one in twenty is cut, or changed outside of them."""
        if self._random.random() < 0.05:
            return self._changed_whole()
        sections = dict(self._sections)
        for _ in range(self._random.integers(1, 5)):
            name = self._names[self._random.integers(len(self._names))]
            sections[name] = self._changed(name, np.frombuffer(sections[name], np.uint8).copy()).tobytes()
        return file_of(sections, self._data)

    def _changed_whole(self) -> bytes:
        body = np.frombuffer(self._data, np.uint8)[_HEADER.size :].copy()
        body[self._random.integers(min(64, len(body)))] = self._random.integers(256)
        body = body[: self._random.integers(1, len(body) + 1)]
        magic, version, _, _ = _HEADER.unpack_from(self._data)
        return _HEADER.pack(magic, version, zlib.crc32(body.tobytes()), len(body)) + body.tobytes()

    def _changed(self, name: bytes, section: Bytes) -> Bytes:
        if len(section) < 2 * _LENGTH.size:
            return section
        kind = self._random.integers(10)
        if kind < 5:
            section = self._other_number(name, section)
        elif kind == 5:
            at = self._random.integers(0, len(section), self._random.integers(1, 4))
            section[at] = self._random.integers(0, 256, len(at))
        elif kind == 6:
            with np.errstate(over="ignore"):
                real = np.array([self._random.choice(_REALS)], self._random.choice(["<f4", "<f8"])).view(np.uint8)
            at = self._random.integers(len(section) - len(real))
            section[at : at + len(real)] = real
        elif kind == 7:
            section[self._random.integers(len(section))] ^= 1 << self._random.integers(8)
        elif kind == 8:
            section = self._moved(section)
        else:
            section = section[: self._random.integers(len(section))]
        return section

    def _other_number(self, name: bytes, section: Bytes) -> Bytes:
        """An id or count replaced by its neighbour, by another of the file, or by one that is at a type's end."""
        places = self._numbers[name]
        places = places[places < len(section) - _LENGTH.size]
        if not len(places):
            return section
        at, other = self._random.choice(places, 2)
        if self._random.random() < 0.4:
            value = section[other : other + _LENGTH.size].copy()
        elif self._random.random() < 0.5:
            step = int(self._random.choice([-1, 1, 1 << 32]))
            value = (section[at : at + _LENGTH.size].copy().view("<i8") + step).view(np.uint8)
        else:
            value = np.array([int(self._random.choice(np.array(_NUMBERS, np.int64)))], "<i8").view(np.uint8)
        section[at : at + _LENGTH.size] = value
        return section

    def _moved(self, section: Bytes) -> Bytes:
        """A piece taken out, doubled, or put in the place of another."""
        size = int(self._random.integers(1, min(200, len(section) // 2) + 1))
        start, target = self._random.integers(0, len(section) - size, 2)
        piece = section[start : start + size].copy()
        which = self._random.integers(3)
        if which == 0:
            return np.delete(section, slice(start, start + size))
        if which == 1:
            return np.insert(section, target, piece)
        section[target : target + size] = piece
        return section
