# SPDX-License-Identifier: Apache-2.0
"""The number of the engine's threads and the machine's load change no byte."""

import hashlib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from services.slam import _engine
from tests.unit.slam.textured_room import TexturedRoom

FRAMES = 16


def bytes_of_a_drive(threads: int, updates_every: int = 1) -> tuple[str, int]:
    """Digest of all poses and of the map at the end, and the number of its keyframes."""
    room = TexturedRoom(seed=3)
    options = _engine.EngineOptions()
    options.threads = threads
    focal_px = float(room.intrinsics[0, 0])
    camera = _engine.CameraModel(room.width, room.height, focal_px, focal_px, room.width / 2, room.height / 2)
    engine = _engine.Engine(camera, options)
    nobody = (None, np.zeros(0, np.uint32), np.zeros(0, np.int32), np.zeros(0, np.uint8), True)
    digest = hashlib.sha256()
    landmarks: dict[int, bytes] = {}
    keyframes: dict[int, bytes] = {}

    def take() -> None:
        update = engine.take_map_update()
        landmarks.update(zip(update["landmark_id"].tolist(), map(bytes, update["landmark_position"]), strict=True))
        keyframes.update(zip(update["keyframe_id"].tolist(), map(bytes, update["keyframe_pose"]), strict=True))
        for number in update["removed_landmark_id"].tolist():
            del landmarks[number]

    for index in range(FRAMES):
        engine.begin_frame((index + 1) * 100_000_000, room.render(index)[0])
        digest.update(engine.finish_frame(*nobody).map_from_camera.tobytes())
        if index % updates_every == 0:
            take()
    engine.flush()
    take()
    for table in (landmarks, keyframes):
        for number in sorted(table):
            digest.update(table[number])
    return digest.hexdigest(), len(keyframes)


@pytest.fixture(scope="module")
def expected() -> str:
    digest, keyframes = bytes_of_a_drive(threads=1)
    assert keyframes > 3
    return digest


@pytest.mark.parametrize("threads", [2, 4])
def test_threads_change_nothing(expected: str, threads: int) -> None:
    assert bytes_of_a_drive(threads)[0] == expected


def test_a_busy_machine_changes_nothing(expected: str) -> None:
    with ThreadPoolExecutor(4) as pool:
        digests = {digest for digest, _ in pool.map(bytes_of_a_drive, [2] * 4)}
    assert digests == {expected}


def test_when_the_map_is_asked_for_changes_nothing(expected: str) -> None:
    assert bytes_of_a_drive(threads=2, updates_every=5)[0] == expected


def test_threads_are_checked() -> None:
    room = TexturedRoom(seed=3)
    options = _engine.EngineOptions()
    options.threads = 0
    camera = _engine.CameraModel(room.width, room.height, 300.0, 300.0, room.width / 2, room.height / 2)
    with pytest.raises(ValueError, match="threads: expected 1 to 64, got 0"):
        _engine.Engine(camera, options)
