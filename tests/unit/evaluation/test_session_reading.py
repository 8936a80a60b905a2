# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import FrameManifest, MotionState, Objects, ObjectTrack, TrueInstances, TrueObject, TruePose
from schemas.topics import Topic
from services.evaluation.run.folder import evaluate_run
from services.evaluation.run.outcome import RunOutcome
from services.evaluation.run.session_reading import read_session
from services.runtime.errors import InputError

mcap_writer = pytest.importorskip("services.recorder.session_writer")
FRAMES = 6


def _write(path: Path, with_truth: bool = True, whole: bool = True) -> Path:
    from services.runtime.session_file import RecordedMessage

    labels = np.zeros((80, 60), np.uint32)
    labels[10:60, 10:30] = 4
    messages = []
    for sequence in range(FRAMES):
        time_ns = 1000 * (sequence + 1)
        box = (10.0, 10.0, 20.0, 50.0)
        seen = TrueInstances(time_ns, labels, (TrueObject(4, "car", True, (3.0, 0, 0), (0, 0, 0), box),))
        state = MotionState.MOVING if sequence >= 2 else MotionState.UNDECIDED
        tracked = Objects(time_ns, labels * 2, (ObjectTrack(8, "car", 0.9, state, 0.9, box, 3),))
        pose = np.eye(4)
        pose[0, 3] = sequence
        records: list[tuple[Topic, object]] = [
            (topics.MANIFEST, FrameManifest(time_ns, "made up", str(sequence), (), FRAMES)),
            (topics.TRUE_POSE, TruePose(time_ns, pose)),
            (topics.OBJECTS, tracked),
        ]
        if with_truth:
            records.append((topics.TRUE_INSTANCES, seen))
        messages += [RecordedMessage(t.key, sequence, time_ns, encode(t, record)) for t, record in records]
    writer = mcap_writer.SessionWriter(path, "the-session")
    writer.append(messages[: len(messages) // 2])
    if whole:
        writer.append(messages[len(messages) // 2 :])
        writer.finish()
    writer.close()
    return path


def test_a_recording_is_read_and_its_moving_flags_counted(tmp_path: Path) -> None:
    session, log = read_session(_write(tmp_path / "a.mcap"))
    assert session == "the-session"
    assert len(log.manifests) == FRAMES
    score = log.moving_flag.score
    assert (score.frames, score.precision, score.recall) == (FRAMES, 1.0, pytest.approx(4 / 6))
    truth = log.truth()
    assert truth is not None
    assert truth.length_m == pytest.approx(FRAMES - 1)


def test_without_truth_no_flags_are_counted(tmp_path: Path) -> None:
    _, log = read_session(_write(tmp_path / "a.mcap", with_truth=False))
    assert log.moving_flag.score.frames == 0


def test_a_cut_off_recording_is_refused_and_can_be_recovered(tmp_path: Path) -> None:
    path = _write(tmp_path / "a.mcap", whole=False)
    with pytest.raises(InputError, match="recover"):
        read_session(path)
    _, log = read_session(path, recover=True)
    assert len(log.manifests) == FRAMES // 2


def test_a_run_that_never_tracked_still_gets_report_and_plots(tmp_path: Path) -> None:
    session = _write(tmp_path / "session.mcap")
    (tmp_path / "trajectory.tum").write_text("")
    report = evaluate_run(tmp_path, session, RunOutcome(every_frame=False), {})
    assert report["frames"]["tracked"] == 0
    assert report["ate"]["final"]["none_because"] == "no tracked pose"
    assert report["moving_flag"]["recall"] == pytest.approx(4 / 6)
    assert (tmp_path / "report.json").is_file()
    assert (tmp_path / "plots" / "map.png").is_file()
    assert len((tmp_path / "ground_truth.tum").read_text().splitlines()) == FRAMES
