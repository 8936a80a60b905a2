# SPDX-License-Identifier: Apache-2.0
"""The engine alone on the first frames of a real drive."""

from pathlib import Path

import pytest

from services.slam import _engine
from tests.benchmark.slam.engine_run import EngineRun, run_kitti, true_centers_m

FRAMES = 60


def first_frames(shared_data: Path, stage: str) -> EngineRun:
    options = _engine.EngineOptions()
    options.stage = getattr(_engine.Stage, stage)
    return run_kitti(shared_data / "kitti" / "sequences" / "03", options, frames=FRAMES)


@pytest.mark.parametrize("stage", ["base", "dynamic", "moving"])
def test_every_stage_starts_soon_and_stays_on_the_road(shared_data: Path, stage: str) -> None:
    run = first_frames(shared_data, stage)
    assert 0 < run.initialized_at() < 20
    assert run.tracked_share() >= 0.97
    assert len(run.relative) >= 0.97 * FRAMES
    assert run.ate_m(true_centers_m(shared_data / "kitti" / "poses" / "03.txt")) < 0.2


def test_the_same_drive_gives_the_same_bytes(shared_data: Path) -> None:
    digests = {first_frames(shared_data, "moving").digest.hexdigest() for _ in range(2)}
    assert len(digests) == 1
