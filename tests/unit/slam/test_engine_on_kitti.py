# SPDX-License-Identifier: Apache-2.0
"""The engine alone on the first frames of a real drive."""

from pathlib import Path

import pytest

from tests.benchmark.slam.engine_pass import EnginePass, PassReport, run_pass
from tests.benchmark.slam.sequence_part import SequencePart

FRAMES = 60


def first_frames(shared_data: Path, stage: str) -> PassReport:
    return run_pass(EnginePass((SequencePart(shared_data / "kitti" / "sequences" / "03", frames=FRAMES),), stage))


@pytest.mark.parametrize("stage", ["base", "dynamic", "moving"])
def test_every_stage_starts_soon_and_stays_on_the_road(shared_data: Path, stage: str) -> None:
    report = first_frames(shared_data, stage)
    assert 0 < report.initialized_at < 20
    assert report.tracked_share >= 0.97
    assert report.coverage >= 0.97
    assert report.ate_m < 0.2


def test_the_same_drive_gives_the_same_bytes(shared_data: Path) -> None:
    digests = {first_frames(shared_data, "moving").digest for _ in range(2)}
    assert len(digests) == 1
