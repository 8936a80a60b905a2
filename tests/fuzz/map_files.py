# SPDX-License-Identifier: Apache-2.0
"""Change a checkpoint at random behind its checksum, and load it, restore it and track in it, for as long as wanted.

    python -m tests.fuzz.map_files [--minutes 60] [--seed 0]

Every file must be refused by one line or be usable. A crash or a file that takes minutes ends this process, which is
what it looks for; that file stays in --folder.
"""

import argparse
import faulthandler
import resource
import time
from collections import Counter
from pathlib import Path

import numpy as np

from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.fuzz.map_file_changes import MapFileChanger
from tests.unit.slam.textured_room import TexturedRoom

_FRAME_NS = 100_000_000
_MOST_SECONDS = 300
_MOST_BYTES = 6 << 30
_WAYS = ("load", "resume", "restore")


def _camera(room: TexturedRoom) -> _engine.CameraModel:
    k = room.intrinsics
    return _engine.CameraModel(room.width, room.height, k[0, 0], k[1, 1], k[0, 2], k[1, 2])


def _options() -> _engine.EngineOptions:
    options = _engine.EngineOptions()
    options.features = 300
    options.vocabulary_path = str(SHIPPED_VOCABULARY)
    return options


def _drive(engine: _engine.Engine, room: TexturedRoom, frames: range, first_time: int) -> None:
    objects = np.zeros((room.height, room.width), np.uint32)
    objects[40:90, 60:140] = 7
    rows = (np.array([7], np.uint32), np.array([2], np.int32), np.array([2], np.uint8))
    for time_index, index in enumerate(frames, first_time):
        engine.begin_frame(time_index * _FRAME_NS, room.render(index)[0])
        engine.finish_frame(objects, *rows, True)
        engine.take_map_update()


def _sound_file(room: TexturedRoom, path: Path) -> bytes:
    engine = _engine.Engine(_camera(room), _options())
    _drive(engine, room, range(16), 1)
    engine.checkpoint(str(path))
    return path.read_bytes()


def _try(room: TexturedRoom, path: Path, way: str) -> bool:
    engine = _engine.Engine(_camera(room), _options())
    try:
        if way == "load":
            engine.load_maps(str(path))
        elif way == "resume":
            engine.resume_maps(str(path), 9)
        else:
            engine.restore(str(path))
    except ValueError as error:
        assert "\n" not in str(error)
        return False
    try:
        _drive(engine, room, range(9, 13), 100)
    except ValueError as error:
        assert str(error).startswith("timestamp_ns"), error  # a restored session may have come far in time
    engine.save_maps(str(path.with_suffix(".again")), False)
    engine.flush()
    engine.take_map_update()
    return True


def main() -> None:
    """Fuzz, and count what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, default=Path("build/fuzz/map_files"))
    parser.add_argument("--only", choices=_WAYS, help="try the file that lies in --folder in this way, as it is")
    arguments = parser.parse_args()
    faulthandler.enable()
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_BYTES, _MOST_BYTES))
    room = TexturedRoom(seed=1)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    path = arguments.folder / "changed.kmap"
    if arguments.only is not None:
        print("used" if _try(room, path, arguments.only) else "refused")
        return
    random = np.random.default_rng(arguments.seed)
    changer = MapFileChanger(_sound_file(room, path), random)
    counts: Counter[str] = Counter()
    end = time.monotonic() + 60 * arguments.minutes
    while time.monotonic() < end:
        way = str(random.choice(_WAYS))
        path.write_bytes(changer.next())
        faulthandler.dump_traceback_later(_MOST_SECONDS, exit=True)
        used = _try(room, path, way)
        counts[f"{way}: {'used' if used else 'refused'}"] += 1
        if counts.total() % 1000 == 0:
            print(f"{counts.total()} files: {dict(sorted(counts.items()))}", flush=True)
    print(f"{counts.total()} files without a crash: {dict(sorted(counts.items()))}")


if __name__ == "__main__":
    main()
