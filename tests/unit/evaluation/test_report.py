# SPDX-License-Identifier: Apache-2.0
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from schemas.codec.rigid import pose_from_matrix
from schemas.records import (
    Density,
    DensityLevel,
    FrameManifest,
    MapUpdate,
    MaskSource,
    TrackedFrame,
    TrackingState,
    TruePose,
)
from services.evaluation.run.comparison import compare
from services.evaluation.run.outcome import Report, RunOutcome, ServiceUsage
from services.evaluation.run.plots import plot_density, plot_map, plot_stage_times, plot_trajectory
from services.evaluation.run.report import (
    build_report,
    read_report,
    stage_times,
    write_report,
)
from services.evaluation.run.session_log import NO_MAP, SessionLog
from services.evaluation.run.summary import summary_rows
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

Drive = Callable[..., Trajectory]
LOST = range(30, 35)
INITIALIZED = 5
FRAMES = 50


def _tracked(index: int, drive: Trajectory) -> TrackedFrame:
    state = TrackingState.INITIALIZING if index < INITIALIZED else TrackingState.TRACKING
    state = TrackingState.LOST if index in LOST else state
    pose = pose_from_matrix(drive.world_from_camera[index]) if state is TrackingState.TRACKING else None
    return TrackedFrame(
        timestamp_ns=int(drive.timestamp_ns[index]),
        state=state,
        reason="",
        map_id=0,
        map_from_camera=pose,
        covariance=None,
        reference_keyframe_id=0,
        camera_from_reference=None,
        features=2000,
        tracked_landmarks=300,
        keyframe_inserted=False,
        masks=MaskSource.FRESH,
        metric_scale=False,
        handling="moving",
        stage_ms={"features": float(index), "total": 2.0 * index},
    )


@pytest.fixture
def log(winding_drive: Drive) -> SessionLog:
    """A drive of 50 frames: initialised at 5, 30 to 34 lost, the rest exactly on the truth; dense from frame 20 on."""
    drive = winding_drive(FRAMES)
    session = SessionLog()
    for index in range(FRAMES):
        time_ns = int(drive.timestamp_ns[index])
        session.add(index, FrameManifest(time_ns, "a drive", f"{index:06d}", (), FRAMES))
        session.add(index, TruePose(time_ns, drive.world_from_camera[index]))
        session.add(index, _tracked(index, drive))
        level = DensityLevel.HIGH if index >= 20 else DensityLevel.LOW
        session.add(index, Density(time_ns, (0.0, 0.0, 0.0), 10.0, 30.0, index, 1, 100, level, False))
        if index == INITIALIZED:
            session.add(index, _map_update(time_ns))
    return session


def _map_update(time_ns: int) -> MapUpdate:
    return MapUpdate(
        timestamp_ns=time_ns,
        keyframe_id=np.array([0]),
        keyframe_timestamp_ns=np.array([time_ns]),
        keyframe_map_id=np.array([0]),
        keyframe_pose=np.array([[0, 0, 0, 0, 0, 0, 1, 1.0]]),
        keyframe_culled=np.zeros(1, np.uint8),
        keyframe_parent_id=np.array([-1]),
        landmark_id=np.arange(6),
        landmark_anchor_id=np.zeros(6, np.int64),
        landmark_position=np.arange(18, dtype=np.float32).reshape(6, 3),
        landmark_state=np.array([0, 0, 0, 1, 2, 3], np.uint8),
        landmark_category=np.full(6, -1, np.int32),
        landmark_object_id=np.zeros(6, np.uint32),
        landmark_first_seen_ns=np.zeros(6, np.int64),
        landmark_last_seen_ns=np.zeros(6, np.int64),
        landmark_valid_until_ns=np.full(6, -1, np.int64),
    )


USAGE = {
    "slam": ServiceUsage(250_000_000, 1, {"process_ms_p50": 21.0, "process_ms_p95": 40.0, "frames": 50.0}),
    "camera": ServiceUsage(90_000_000, 2, {"read_ms_p50": 3.0, "read_ms_p95": 5.0}),
}


@pytest.fixture
def report(log: SessionLog) -> Report:
    return build_report(log, log.live_trajectory(), USAGE, RunOutcome("s", "", 8.0, 4.9))


def test_frames_are_accounted_for(report: Report) -> None:
    frames = report["frames"]
    assert (frames["in"], frames["expected"], frames["answered"]) == (50, 50, 50)
    assert (frames["tracked"], frames["lost"], frames["initializing"]) == (40, 5, 5)
    assert frames["initialized_at"] == 5
    assert frames["tracked_after_initialization"] == pytest.approx(40 / 45)
    assert report["frames_per_s"] == pytest.approx(10.0)


def test_ate_stands_beside_its_coverage(report: Report) -> None:
    assert report["ate"]["final"]["ate_m"]["rmse"] < 1e-9
    assert report["ate"]["final"]["coverage"] == pytest.approx(0.8)
    assert report["ate"]["live"]["frames"] == 50


def test_live_poses_from_before_the_map_was_metric_are_in_other_units(log: SessionLog) -> None:
    for key, frame in log.tracked.items():
        if key >= 15:
            log.tracked[key] = replace(frame, metric_scale=True)
        elif frame.map_from_camera is not None:
            pose = frame.map_from_camera.copy()
            pose[:3] *= 0.1
            log.tracked[key] = replace(frame, map_from_camera=pose)
    live = log.live_trajectory()
    assert live is not None
    assert len(live) == 30
    assert build_report(log, live, {}, RunOutcome())["ate"]["live"]["ate_m"]["rmse"] < 1e-9


def test_a_run_that_never_initialised_says_so(log: SessionLog) -> None:
    log.tracked = {key: frame for key, frame in log.tracked.items() if key < INITIALIZED}
    report = build_report(log, None, {}, RunOutcome())
    assert report["ate"]["final"] == {"alignment": "sim3", "none_because": "no tracked pose"}
    assert report["frames"]["initialized_at"] is None
    assert any(what == "ATE final" and "no tracked pose" in value for what, value in summary_rows(report))


def test_the_main_map_is_the_one_most_frames_were_tracked_in(log: SessionLog) -> None:
    assert log.main_map_id() == 0
    log.tracked = {key: replace(frame, map_id=3) if key >= 20 else frame for key, frame in log.tracked.items()}
    assert log.main_map_id() == 3
    live = log.live_trajectory()
    assert live is not None
    assert len(live) == 25
    assert SessionLog().main_map_id() == NO_MAP


def test_without_truth_there_is_no_ate(log: SessionLog) -> None:
    log.true_poses.clear()
    assert build_report(log, log.live_trajectory(), {}, RunOutcome())["ate"] is None


@pytest.mark.parametrize(
    ("outcome", "complete"),
    [(RunOutcome(), False), (RunOutcome(every_frame=False), True), (RunOutcome(failure="x"), False)],
)
def test_a_missing_answer_makes_a_lossless_run_incomplete(log: SessionLog, outcome: RunOutcome, complete: bool) -> None:
    del log.tracked[17]
    report = build_report(log, None, {}, outcome)
    assert report["complete"] is complete
    if not outcome.failure and not complete:
        assert "50 frames in the input, 50 recorded, 49 answered by slam" in report["failure"]


def test_no_frame_at_all_is_not_complete() -> None:
    assert build_report(SessionLog(), None, {}, RunOutcome())["complete"] is False


def test_stage_times_are_percentiles(log: SessionLog) -> None:
    times = stage_times(log, USAGE)
    assert times["slam/features"]["p50"] == pytest.approx(24.5)
    assert times["slam/total"]["p95"] == pytest.approx(2 * np.percentile(np.arange(50), 95))
    assert times["slam"] == {"p50": 21.0, "p95": 40.0}
    assert times["camera/read"] == {"p50": 3.0, "p95": 5.0}
    assert "slam/frames" not in times


def test_landmarks_density_and_memory(report: Report) -> None:
    assert report["landmarks"] == {
        "static": 3, "non_moving": 1, "moving": 1, "undecided": 1, "potentially_dynamic": 0,
    }  # fmt: skip
    assert report["density_frames"] == {"unknown": 0, "low": 20, "high": 30}
    assert report["services"]["slam"] == {"peak_memory_bytes": 250_000_000, "starts": 1}
    assert report["moving_flag"] is None


def test_a_message_recorded_twice_counts_once(log: SessionLog, report: Report, winding_drive: Drive) -> None:
    drive = winding_drive(FRAMES)
    log.add(10, FrameManifest(int(drive.timestamp_ns[10]), "a drive", "000010", (), FRAMES))
    log.add(10, _tracked(10, drive))
    log.add(INITIALIZED, _map_update(0))
    again = build_report(log, log.live_trajectory(), USAGE, RunOutcome("s", "", 8.0, 4.9))
    assert again == report


def test_report_comes_back_and_holds_no_nan(report: Report, tmp_path: Path) -> None:
    report["wall_s"] = float("nan")
    write_report(report, tmp_path / "report.json")
    assert "NaN" not in (tmp_path / "report.json").read_text()
    assert read_report(tmp_path / "report.json") == {**json.loads(json.dumps(report)), "wall_s": None}


@pytest.mark.parametrize(
    ("content", "expected"),
    [(None, "no such report"), ("{", "not a report"), ('{"version": 99}', "version 99, expected")],
)
def test_a_report_that_is_none_is_refused(tmp_path: Path, content: str | None, expected: str) -> None:
    if content is not None:
        (tmp_path / "report.json").write_text(content)
    with pytest.raises(InputError, match=expected):
        read_report(tmp_path / "report.json")


def test_summary_names_what_issue_and_user_ask_for(report: Report) -> None:
    rows = dict(summary_rows(report))
    assert rows["frames"] == "50 of 50 in, 40 tracked, 5 lost, 5 initializing"
    assert "sim3, 40 of 50 frames = 80.0%" in rows["ATE final"]
    assert rows["peak memory"] == "camera 86, slam 238 MiB"
    assert rows["slam"] == "21.0 ms median, 40.0 ms p95"


def test_summary_says_how_far_a_metric_maps_metres_are_off(report: Report) -> None:
    assert "off" not in dict(summary_rows(report))["ATE final"]
    final = report["ate"]["final"]
    report["ate"] = {"final": {**final, "scale": 0.98}, "final_metric": {**final, "alignment": "se3", "scale": 1.0}}
    rows = dict(summary_rows(report))
    assert rows["ATE final_metric"].endswith("80.0%), scale 2.00% off")


def test_runs_stand_side_by_side(log: SessionLog, report: Report) -> None:
    log.true_poses.clear()
    other = build_report(log, None, {}, RunOutcome())
    rows = {row.what: row.values for row in compare([report, other])}
    assert rows["stage"] == ("moving", "moving")
    assert rows["ATE final coverage"] == ("80.0%", "-")
    assert rows["landmarks static"] == ("3", "3")
    assert rows["camera/read p50/p95 [ms]"] == ("3.0/5.0", "-")
    assert "moving flag f1" not in rows


def test_plots_are_pictures_and_the_same_bytes_every_time(log: SessionLog, tmp_path: Path) -> None:
    drive, truth = log.live_trajectory(), log.truth()
    assert drive is not None
    pictures = []
    for name in ("first", "second"):
        folder = tmp_path / name
        folder.mkdir()
        plot_trajectory(drive, folder / "trajectory.png", truth)
        plot_map(log.map_points.points(0), drive, folder / "map.png")
        plot_stage_times(stage_times(log, USAGE), folder / "stage_times.png")
        plot_density(log.densities, folder / "density.png")
        pictures.append({path.name: path.read_bytes() for path in folder.iterdir()})
    assert pictures[0] == pictures[1]
    assert len(pictures[0]) == 4
    assert all(data.startswith(b"\x89PNG") and len(data) > 10_000 for data in pictures[0].values())


def test_plots_of_nothing_are_drawn_too(tmp_path: Path) -> None:
    empty = SessionLog()
    plot_map(empty.map_points.points(-1), None, tmp_path / "map.png")
    plot_stage_times({}, tmp_path / "stage_times.png")
    plot_density({}, tmp_path / "density.png")
    assert len(list(tmp_path.iterdir())) == 3
