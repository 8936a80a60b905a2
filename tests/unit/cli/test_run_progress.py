# SPDX-License-Identifier: Apache-2.0
import io

import numpy as np
import pytest
from rich.console import Console

from schemas.records import (
    Density,
    DensityLevel,
    Heartbeat,
    MaskSource,
    TrackedFrame,
    TrackingState,
)
from services.cli.progress_view import ProgressBar, ProgressLines, progress_view
from services.cli.run_progress import RunProgress


def _tracked(time_ns: int, state: TrackingState = TrackingState.TRACKING) -> TrackedFrame:
    return TrackedFrame(
        time_ns, state, "", 0, None, None, -1, None, 2000, 100, False, MaskSource.FRESH, False, "moving"
    )


def _beat(
    service: str, pid: int = 1, state: str = "running", sequence: int = 0, memory: int = 1, **metrics: float
) -> Heartbeat:
    return Heartbeat(service, pid, state, sequence, memory, metrics)


@pytest.fixture
def progress() -> RunProgress:
    """Twenty of fifty frames at 4 frames a second, density high."""
    running = RunProgress(total=50)
    for index in range(20):
        running.add(index, _tracked(index), 0.25 * index)
    running.add(19, Density(19, (0.0, 0.0, 0.0), 10.0, 30.0, 12, 2, 100, DensityLevel.HIGH, False), 5.0)
    running.add(3, _beat("mapstore", landmarks_static=900.0, landmarks_moving=12.0, landmarks_undecided=0.0), 5.0)
    return running


def test_line_says_frames_rate_state_landmarks_and_density(progress: RunProgress) -> None:
    assert progress.line() == "20/50 frames, 4.0 fps, tracking, 900 static 12 moving, density high"


def test_driven_time_is_from_the_first_frame_to_the_last(progress: RunProgress) -> None:
    assert progress.driven_s == pytest.approx(4.75)


def test_a_frame_sent_again_moves_nothing(progress: RunProgress) -> None:
    progress.add(4, _tracked(4, TrackingState.LOST), 5.0)
    assert (progress.frames, progress.state) == (20, "tracking")


def test_rate_is_of_the_last_seconds(progress: RunProgress) -> None:
    for index in range(20, 120):
        progress.add(index, _tracked(index), 5.0 + 0.1 * (index - 20))
    assert progress.frames_per_s == pytest.approx(10.0, rel=0.02)


def test_peak_memory_outlives_a_restart_and_starts_are_counted() -> None:
    progress = RunProgress()
    progress.add(0, _beat("slam", pid=10, memory=700), 0.0)
    progress.add(1, _beat("slam", pid=11, memory=300, process_ms_p50=4.0), 1.0)
    progress.add(2, _beat("slam", pid=11, memory=400), 2.0)
    usage = progress.services["slam"]
    assert (usage.peak_memory_bytes, usage.starts) == (700, 2)


def test_done_is_the_cameras_word_alone() -> None:
    progress = RunProgress()
    progress.add(0, _beat("recorder", state="done"), 0.0)
    assert not progress.done
    progress.add(0, _beat("camera", state="done"), 0.0)
    assert progress.done


def test_change_is_progress_and_a_repeated_heartbeat_is_none() -> None:
    progress = RunProgress()
    progress.add(0, _beat("camera", sequence=3), 10.0)
    progress.add(1, _beat("camera", sequence=3), 11.0)
    assert progress.last_change_s == 10.0
    progress.add(2, _beat("camera", sequence=4), 12.0)
    assert progress.last_change_s == 12.0
    assert progress.waiting_for() == "camera running at 4"


def test_without_a_terminal_lines_come_now_and_then(progress: RunProgress) -> None:
    text = io.StringIO()
    view = progress_view(Console(file=text))
    assert isinstance(view, ProgressLines)
    with view:
        for now_s in np.arange(0.0, 14.0, 0.2):
            progress.add(20 + int(now_s), _tracked(0), 6.0 + now_s)
            view.show(progress, float(now_s))
    lines = text.getvalue().splitlines()
    assert len(lines) == 2
    assert all("/50 frames" in line and "density high" in line for line in lines)


def test_on_a_terminal_there_is_one_bar_with_everything(progress: RunProgress) -> None:
    text = io.StringIO()
    console = Console(file=text, force_terminal=True, width=160, color_system=None)
    view = progress_view(console)
    assert isinstance(view, ProgressBar)
    with view:
        view.show(progress, 5.0)
    last = [line for line in text.getvalue().splitlines() if "/50" in line][-1]
    for part in ("20/50", "4.0 fps", "tracking", "900 static", "12 moving", "density high"):
        assert part in last
