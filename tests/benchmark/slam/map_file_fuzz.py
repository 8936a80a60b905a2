# SPDX-License-Identifier: Apache-2.0
"""Change a map file at random, with a checksum that fits again, and load it and track in it, for as long as wanted.

    python -m tests.benchmark.slam.map_file_fuzz [--minutes 60] [--seed 0]

Every file must be refused by one line or be usable; a crash ends this process, which is what it looks for.
"""

import argparse
import struct
import tempfile
import time
import zlib
from collections import Counter
from pathlib import Path

import numpy as np

from services.slam import _engine
from tests.unit.slam.textured_room import TexturedRoom

_HEADER = struct.Struct("<8sIIQ")
_FRAME_NS = 100_000_000


def _camera(room: TexturedRoom) -> _engine.CameraModel:
    k = room.intrinsics
    return _engine.CameraModel(room.width, room.height, k[0, 0], k[1, 1], k[0, 2], k[1, 2])


def _options() -> _engine.EngineOptions:
    options = _engine.EngineOptions()
    options.features = 300
    return options


def _drive(engine: _engine.Engine, room: TexturedRoom, frames: range) -> None:
    nobody = (np.empty(0, np.uint32), np.empty(0, np.int32), np.empty(0, np.uint8))
    for index in frames:
        engine.begin_frame((index + 1) * _FRAME_NS, room.render(index)[0])
        engine.finish_frame(None, *nobody, True)
        engine.take_map_update()


def changed(data: bytes, random: np.random.Generator) -> bytes:
    """Some bytes of the body replaced, or its end cut off, under a header that fits."""
    body = np.frombuffer(data, np.uint8)[_HEADER.size :].copy()
    if random.random() < 0.1:
        body = body[: random.integers(1, len(body))]
    at = random.integers(0, len(body), random.integers(1, 9))
    body[at] = random.integers(0, 256, len(at))
    whole = body.tobytes()
    magic, version, _, _ = _HEADER.unpack_from(data)
    return _HEADER.pack(magic, version, zlib.crc32(whole), len(whole)) + whole


def main() -> None:
    """Fuzz, and count what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    room = TexturedRoom(seed=1)
    random = np.random.default_rng(arguments.seed)
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "room.kmap"
        engine = _engine.Engine(_camera(room), _options())
        _drive(engine, room, range(12))
        engine.save_maps(str(path), False)
        data = path.read_bytes()
        end = time.monotonic() + 60 * arguments.minutes
        while time.monotonic() < end:
            path.write_bytes(changed(data, random))
            engine = _engine.Engine(_camera(room), _options())
            try:
                engine.load_maps(str(path))
            except ValueError as error:
                assert str(error).startswith(f"map file {path}: ")
                assert "\n" not in str(error)
                counts["refused"] += 1
                continue
            _drive(engine, room, range(6, 9))
            engine.flush()
            counts["used"] += 1
    print(f"{counts.total()} files: {counts['refused']} refused, {counts['used']} used, no crash")


if __name__ == "__main__":
    main()
