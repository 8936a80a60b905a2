# SPDX-License-Identifier: Apache-2.0
"""All services together on the fake bus: every frame accounted for, and the same bytes however the run went."""

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.records import TrackingState
from services.mapstore.export import export_map
from tests.pipeline_rig import SHORT_FRAMES, PipelineRig, short_drive


def digests(rig: PipelineRig) -> dict[str, str]:
    out = rig.config.run.out
    files = export_map(out / "map.sqlite", out, ("tum", "pcd"))
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def drive(
    out: Path, interfere: Callable[[PipelineRig], None] = lambda rig: None, **sections: dict[str, object]
) -> PipelineRig:
    rig = PipelineRig(short_drive(out, **sections))
    rig.run(interfere)
    return rig


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> PipelineRig:
    return drive(tmp_path_factory.mktemp("undisturbed"))


def test_every_frame_has_every_message(undisturbed: PipelineRig) -> None:
    for topic in topics.TOPICS:
        if topic.per_frame and topic not in (topics.IMAGE_RIGHT, topics.CALIBRATION_RIGHT):
            expected = set(range(SHORT_FRAMES))
            heard = set(undisturbed.payloads[topic])
            # The last map update belongs to the end of input, one past the last frame.
            assert heard - {SHORT_FRAMES} == expected, topic.key


def test_the_camera_is_followed_and_things_are_told_apart(undisturbed: PipelineRig) -> None:
    tracked = undisturbed.records(topics.TRACKED_FRAME)
    states = [frame.state for frame in tracked.values()]
    first = states.index(TrackingState.TRACKING)
    assert first <= 20
    assert all(state is TrackingState.TRACKING for state in states[first:])
    true_steps = [pose.world_from_camera[:3, 3] for pose in undisturbed.records(topics.TRUE_POSE).values()]
    driven_m = np.linalg.norm(true_steps[-1] - true_steps[first])
    last = tracked[SHORT_FRAMES - 1].map_from_camera
    assert np.linalg.norm(last[:3] - tracked[first].map_from_camera[:3]) == pytest.approx(driven_m, rel=0.15)
    assert abs(last[2]) < 0.1 * driven_m, "z is up: the street is level"


def test_only_whom_the_table_names_gives_a_topic(undisturbed: PipelineRig) -> None:
    answers = undisturbed.payloads[topics.ANSWER]
    assert set(answers) == set(range(SHORT_FRAMES + 1))


def test_the_same_run_gives_the_same_bytes(undisturbed: PipelineRig, tmp_path: Path) -> None:
    assert digests(drive(tmp_path)) == digests(undisturbed)


def test_a_smaller_window_gives_the_same_bytes(undisturbed: PipelineRig, tmp_path: Path) -> None:
    assert digests(drive(tmp_path, delivery={"window": 2})) == digests(undisturbed)


@pytest.mark.parametrize("name", ["segmenter", "motion", "tracker", "mapstore"])
def test_a_killed_service_changes_no_byte(undisturbed: PipelineRig, tmp_path: Path, name: str) -> None:
    killed_at: list[int] = []

    def kill_once(rig: PipelineRig) -> None:
        sequence = rig.loops["slam"].sequence
        if sequence >= SHORT_FRAMES // 2 and not killed_at:
            killed_at.append(sequence)
            rig.restart(name)

    rig = drive(tmp_path, kill_once, delivery={"resend_after_s": 0.3})
    assert killed_at
    assert digests(rig) == digests(undisturbed)
