# SPDX-License-Identifier: Apache-2.0
"""The engine alone on the first frames of a real drive."""

from pathlib import Path

import pytest

from services.slam import _engine
from tests.benchmark.slam.engine_pass import EnginePass, PassReport, run_pass
from tests.benchmark.slam.engine_run import FRAME_NS, EngineRun
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


def test_the_lens_is_known_long_before_the_end_and_lasts(shared_data: Path, tmp_path: Path) -> None:
    part = SequencePart(shared_data / "kitti" / "sequences" / "03", start=100, frames=75)
    frames = list(part.read())
    height, width = frames[0].image.shape
    camera = _engine.CameraModel(width, height, *part.intrinsics(), [], 0.0)
    first = EngineRun(_engine.Engine(camera, _engine.EngineOptions()))
    for frame in frames[:70]:
        first.step(frame)
    assert first.engine.remaining_radial == pytest.approx(0.0148, abs=0.002)
    first.engine.checkpoint(str(tmp_path / "after.kmap"))
    restored = _engine.Engine(camera, _engine.EngineOptions())
    restored.restore(str(tmp_path / "after.kmap"))
    assert restored.remaining_radial == first.engine.remaining_radial
    ends = []
    for engine in (first.engine, restored):
        for number, frame in enumerate(frames[70:], start=71):
            engine.begin_frame(number * FRAME_NS, frame.image)
            tracked = engine.finish_frame(*frame.objects, masks_fresh=True)
        ends.append(tracked.map_from_camera.tobytes())
    assert ends[0] == ends[1]
    localizer = _engine.Engine(camera, _engine.EngineOptions())
    localizer.load_maps(str(tmp_path / "after.kmap"))
    assert localizer.remaining_radial == first.engine.remaining_radial
