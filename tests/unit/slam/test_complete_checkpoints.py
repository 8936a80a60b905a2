# SPDX-License-Identifier: Apache-2.0
"""An engine restored from a checkpoint is the engine that took it: nothing that it carried begins anew."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.unit.slam.textured_room import TexturedRoom

FRAMES = 20
NOBODY = (None, np.empty(0, np.uint32), np.empty(0, np.int32), np.empty(0, np.uint8))
OPTIONS: dict[str, dict[str, float]] = {
    "plain": {},
    "road": {"camera_height_m": 2.0},
    "semi-dense": {"semi_dense": True},
}


class SettledDrive:
    """A drive down the room that settles at some frames; only what it tells counts, and what it told then."""

    def __init__(self, options: dict[str, float], settled_at: range) -> None:
        self._room = TexturedRoom(seed=4)
        self._settled_at = settled_at
        k = self._room.intrinsics
        engine_options = _engine.EngineOptions()
        engine_options.features = 2000
        engine_options.vocabulary_path = str(SHIPPED_VOCABULARY)
        for name, value in options.items():
            setattr(engine_options, name, value)
        camera = _engine.CameraModel(self._room.width, self._room.height, k[0, 0], k[1, 1], k[0, 2], k[1, 2])
        self.engine = _engine.Engine(camera, engine_options)
        self.roads = 0
        self.semi_dense_points = 0

    def told(self, folder: Path | None) -> list[str]:
        """Digests of what came out, frame by frame; with a `folder`, a checkpoint takes the engine's place at times."""
        digests = []
        for index in range(FRAMES):
            self.engine.begin_frame((index + 1) * 100_000_000, self._room.render(index)[0])
            result = self.engine.finish_frame(*NOBODY, True)
            self.roads += result.road_distance > 0
            if index in self._settled_at:
                self.engine.settle()
            digests.append(self._digest(result.map_from_camera.tobytes() + result.reason.encode()))
            if index in self._settled_at and folder is not None:
                self.engine.checkpoint(str(folder / "state.kmap"))
        self.engine.flush()
        return [*digests, self._digest(b"")]

    def _digest(self, told: bytes) -> str:
        update = self.engine.take_map_update()
        self.semi_dense_points += len(update["dense_point_grey"])
        return hashlib.sha256(told + b"".join(update[name].tobytes() for name in sorted(update))).hexdigest()


@pytest.mark.parametrize("settled_at", [range(0, 1), range(5, FRAMES, 7)], ids=["before the map", "in the map"])
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS.keys())
def test_nothing_begins_anew(options: dict[str, float], settled_at: range, tmp_path: Path) -> None:
    running, restored = SettledDrive(options, settled_at), SettledDrive(options, settled_at)
    assert restored.told(tmp_path) == running.told(None)
    assert ("camera_height_m" in options) == (running.roads > 5)
    assert ("semi_dense" in options) == (running.semi_dense_points > 1000)


def test_a_checkpoint_of_other_options_is_refused(tmp_path: Path) -> None:
    SettledDrive({"semi_dense": True}, range(5, 6)).told(tmp_path)
    with pytest.raises(ValueError, match="session of other options"):
        SettledDrive({}, range(0)).engine.restore(str(tmp_path / "state.kmap"))


def test_maps_are_loaded_before_the_first_frame_and_once(tmp_path: Path) -> None:
    drive = SettledDrive({}, range(5, 6))
    drive.told(tmp_path)
    file = str(tmp_path / "state.kmap")
    with pytest.raises(RuntimeError, match="before the first frame"):
        drive.engine.load_maps(file)
    fresh = SettledDrive({}, range(0)).engine
    fresh.load_maps(file)
    with pytest.raises(RuntimeError, match="before the first frame"):
        fresh.resume_maps(file, 9)
