# SPDX-License-Identifier: Apache-2.0
"""Change a checkpoint at random behind its checksum, and load it, restore it and track in it, for as long as wanted.

    python -m tests.fuzz.map_files [--minutes 60] [--seed 0]

Every file must be refused by one line or be usable. A crash or a file that takes minutes ends this process, which is
what it looks for; that file stays in --folder, with how it was tried beside it.
"""

import argparse
import faulthandler
import resource
import time
from collections import Counter
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Drive:
    """What a sound file is of."""

    features: int
    with_depth: bool
    semi_dense: bool
    camera_height_m: float


_DRIVES = {"depth": Drive(300, True, True, 0.0), "road": Drive(1500, False, False, 2.0)}


def _camera(room: TexturedRoom) -> _engine.CameraModel:
    k = room.intrinsics
    return _engine.CameraModel(room.width, room.height, k[0, 0], k[1, 1], k[0, 2], k[1, 2])


def _options(drive: Drive) -> _engine.EngineOptions:
    options = _engine.EngineOptions()
    options.features = drive.features
    options.camera_height_m = drive.camera_height_m
    options.semi_dense = drive.semi_dense
    options.vocabulary_path = str(SHIPPED_VOCABULARY)
    return options


def _show(engine: _engine.Engine, drive: Drive, room: TexturedRoom, frames: range, first_time: int) -> None:
    objects = np.zeros((room.height, room.width), np.uint32)
    objects[40:90, 60:140] = 7
    rows = (np.array([7], np.uint32), np.array([2], np.int32), np.array([2], np.uint8))
    for time_index, index in enumerate(frames, first_time):
        image, depth_m = room.render(index)
        engine.begin_frame(time_index * _FRAME_NS, image, None, depth_m if drive.with_depth else None)
        engine.finish_frame(objects, *rows, True)
        engine.take_map_update()


def _sound_file(drive: Drive, room: TexturedRoom, path: Path) -> bytes:
    engine = _engine.Engine(_camera(room), _options(drive))
    _show(engine, drive, room, range(16), 1)
    assert engine.next_map_id == 1, "nothing was mapped"
    engine.checkpoint(str(path))
    return path.read_bytes()


def _try(drive: Drive, room: TexturedRoom, path: Path, way: str) -> bool:
    engine = _engine.Engine(_camera(room), _options(drive))
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
        _show(engine, drive, room, range(9, 13), 100)
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
    parser.add_argument("--only", nargs=2, metavar=("DRIVE", "WAY"), help="try the file in --folder so, as it is")
    arguments = parser.parse_args()
    faulthandler.enable()
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_BYTES, _MOST_BYTES))
    room = TexturedRoom(seed=1)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    path = arguments.folder / "changed.kmap"
    if arguments.only is not None:
        print("used" if _try(_DRIVES[arguments.only[0]], room, path, arguments.only[1]) else "refused")
        return
    random = np.random.default_rng(arguments.seed)
    changers = {name: MapFileChanger(_sound_file(drive, room, path), random) for name, drive in _DRIVES.items()}
    counts: Counter[str] = Counter()
    end = time.monotonic() + 60 * arguments.minutes
    while time.monotonic() < end:
        name, way = str(random.choice(list(_DRIVES))), str(random.choice(_WAYS))
        path.write_bytes(changers[name].next())
        (arguments.folder / "tried.txt").write_text(f"--only {name} {way}\n", encoding="ascii")
        faulthandler.dump_traceback_later(_MOST_SECONDS, exit=True)
        used = _try(_DRIVES[name], room, path, way)
        counts[f"{name}, {way}: {'used' if used else 'refused'}"] += 1
        if counts.total() % 500 == 0:
            print(f"{counts.total()} files: {dict(sorted(counts.items()))}", flush=True)
    print(f"{counts.total()} files without a crash: {dict(sorted(counts.items()))}")


if __name__ == "__main__":
    main()
