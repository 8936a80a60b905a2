# SPDX-License-Identifier: Apache-2.0
"""A run with services that are no processes: what the command makes of what it hears."""

import io
import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from schemas import topics
from schemas.codec import encode
from schemas.records import EndOfInput, FrameManifest, Heartbeat, MapUpdate, MaskSource, TrackedFrame, TrackingState
from schemas.topics import Topic
from services.cli.pipeline_run import IncompleteRunError, InterruptedRunError, PipelineRun
from services.cli.run_watch import RunWatch, StuckError
from services.recorder.session_writer import SessionWriter
from services.runtime.config import Config, load_config
from services.runtime.envelope import Envelope
from services.runtime.errors import InputError, KinemapError
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.session_file import RecordedMessage

SESSION = "a-session"


def _tracked(time_ns: int) -> TrackedFrame:
    pose = np.array([0.1 * time_ns, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    state = TrackingState.TRACKING
    return TrackedFrame(
        time_ns, state, "", 0, pose, np.eye(6), 0, pose, 9, 9, False, MaskSource.FRESH, False, "base", 0, {"total": 3.0}
    )


class PlayedServices:
    """Plays what the services of a run would say, at once, when they are started; records it as the recorder would."""

    def __init__(self, config: Config, bus: FakeBus, frames: int = 8, answered: int = 8) -> None:
        self.calls: list[str] = []
        self.error: KinemapError | None = None
        self.on_up: Callable[[], None] = lambda: None
        self._config, self._bus, self._frames, self._answered = config, bus, frames, answered

    def up(self) -> None:
        self.calls.append("up")
        self.on_up()
        messages: list[RecordedMessage] = []
        for sequence in range(self._frames):
            time_ns = 1000 + sequence
            records: list[tuple[Topic, object]] = [
                (topics.MANIFEST, FrameManifest(time_ns, "played", str(sequence), (), self._frames))
            ]
            if sequence < self._answered:
                records += [(topics.TRACKED_FRAME, _tracked(time_ns)), (topics.MAP_UPDATE, MapUpdate(time_ns))]
            for topic, record in records:
                self._say(topic, record, sequence, time_ns)
                messages.append(RecordedMessage(topic.key, sequence, time_ns, encode(topic, record)))
        end = EndOfInput(9999, self._frames)
        messages.append(RecordedMessage(topics.END.key, self._frames, 9999, encode(topics.END, end)))
        writer = SessionWriter(self._config.run.out / "session.mcap", SESSION)
        writer.append(messages)
        writer.finish()
        writer.close()
        self.beat("slam", "running")
        self.beat("camera", "done")

    def down(self) -> None:
        self.calls.append("down")

    def failure(self) -> KinemapError | None:
        return self.error

    def beat(self, service: str, state: str) -> None:
        record = Heartbeat(
            service, 7, state, self._frames - 1, 50 << 20, {"process_ms_p50": 2.0, "process_ms_p95": 4.0}
        )
        self._say(topics.HEARTBEAT, record, 0, 0, service)

    def _say(self, topic: Topic, record: object, sequence: int, time_ns: int, suffix: str = "") -> None:
        self._bus.publish(topic, encode(topic, record), Envelope(SESSION, sequence, time_ns), suffix)


class Stage:
    """A run on played services, and what it printed."""

    def __init__(self, out: Path, save_map: Path | None = None, **played: int) -> None:
        out.mkdir(exist_ok=True)
        network = FakeNetwork()
        config = load_config(None, {"run": {"out": out, "session": SESSION}, "slam": {"save_map": save_map}})
        self.folder = out
        self.services = PlayedServices(config, FakeBus(network), **played)
        self._text = io.StringIO()
        self.run = PipelineRun(config, self.services, FakeBus(network), Console(file=self._text, width=120), 8)

    @property
    def report(self) -> dict[str, object]:
        return dict(json.loads((self.folder / "report.json").read_text()))

    @property
    def printed(self) -> str:
        return self._text.getvalue()


def test_a_whole_run_ends_with_a_report_plots_and_a_summary(tmp_path: Path) -> None:
    stage = Stage(tmp_path)
    stage.run.drive(serve=False)
    assert stage.report["complete"] is True
    assert stage.report["stage"] == "base"
    assert stage.report["services"]["slam"]["peak_memory_bytes"] == 50 << 20  # type: ignore[index]
    assert {path.name for path in (tmp_path / "plots").iterdir()} == {"map.png", "stage_times.png", "density.png"}
    assert "8 of 8 in, 8 tracked, 0 lost" in stage.printed
    assert stage.services.calls == ["up", "down", "down"]


def test_the_summary_says_where_the_map_went(tmp_path: Path) -> None:
    saved = tmp_path / "town.kmap"
    stage = Stage(tmp_path / "saves", save_map=saved)
    stage.services.on_up = saved.touch
    stage.run.drive(serve=False)
    assert f"map saved {saved}" in " ".join(stage.printed.split())


def test_the_summary_says_that_a_map_was_not_written(tmp_path: Path) -> None:
    old = tmp_path / "town.kmap"
    old.touch()
    os.utime(old, (1.0, 1.0))
    stage = Stage(tmp_path / "saves_not", save_map=old)
    stage.run.drive(serve=False)
    assert "was not written" in stage.printed


def test_a_frame_that_slam_never_answered_fails_the_run(tmp_path: Path) -> None:
    stage = Stage(tmp_path, answered=7)
    with pytest.raises(IncompleteRunError, match="8 frames in the input, 8 recorded, 7 answered by slam") as raised:
        stage.run.drive(serve=False)
    assert raised.value.exit_code == 1
    assert stage.report["complete"] is False


def test_a_service_that_gives_up_ends_the_run_with_its_own_error(tmp_path: Path) -> None:
    stage = Stage(tmp_path)
    stage.services.error = InputError("image 000005.png: 5x5, expected 8x8")
    stage.services.beat = lambda *_: None  # type: ignore[method-assign]
    with pytest.raises(InputError, match=r"image 000005\.png"):
        stage.run.drive(serve=False)
    assert stage.report["complete"] is False
    assert stage.report["failure"] == "image 000005.png: 5x5, expected 8x8"
    assert stage.services.calls[-1] == "down"


def test_ctrl_c_keeps_what_is_there(tmp_path: Path) -> None:
    stage = Stage(tmp_path)

    def interrupt(*_: str) -> None:
        raise KeyboardInterrupt

    stage.services.beat = interrupt  # type: ignore[method-assign]
    with pytest.raises(InterruptedRunError) as raised:
        stage.run.drive(serve=False)
    assert raised.value.exit_code == 130
    assert "stopped by the user" in str(stage.report["failure"])
    assert stage.services.calls[-1] == "down"


def test_services_that_do_not_start_leave_no_traceback_and_nothing_running(tmp_path: Path) -> None:
    stage = Stage(tmp_path)

    def fail() -> None:
        raise KinemapError("motion does not start; see logs/motion.log")

    stage.services.on_up = fail
    with pytest.raises(KinemapError, match="motion does not start"):
        stage.run.drive(serve=False)
    assert stage.services.calls == ["up", "down", "down"]
    assert not (tmp_path / "report.json").exists()


def test_served_services_stay_up_until_they_fail_or_the_user_leaves(tmp_path: Path) -> None:
    stage = Stage(tmp_path)
    failures = iter([None, None, None, KinemapError("mapstore: gone")])
    stage.services.failure = lambda: next(failures)  # type: ignore[method-assign]
    stage.run._watch.step = lambda timeout_s: _heard(stage, timeout_s)  # type: ignore[method-assign]
    with pytest.raises(KinemapError, match="mapstore: gone"):
        stage.run.drive(serve=True)
    assert "serving http://127.0.0.1:8000 until Ctrl-C" in stage.printed
    assert stage.report["complete"] is True
    assert stage.services.calls == ["up", "down"]


def _heard(stage: Stage, timeout_s: float) -> bool:
    # As the watch does, without waiting for what does not come.
    return RunWatch.step(stage.run._watch, min(timeout_s, 0.0))


def test_a_run_in_which_nothing_goes_on_is_ended(tmp_path: Path) -> None:
    network = FakeNetwork()
    bus = FakeBus(network)
    stage = Stage(tmp_path)
    now_s = iter(np.arange(0.0, 1000.0, 5.0).tolist())
    watch = RunWatch(
        bus.subscribe([topics.HEARTBEAT]),
        stage.run.progress,
        lambda: None,
        SESSION,
        stuck_after_s=60.0,
        clock=lambda: next(now_s),
    )
    watch.step = lambda timeout_s: False  # type: ignore[method-assign]

    class NoView:
        def show(self, *_: object) -> None:
            return None

    with pytest.raises(StuckError, match="nothing has gone on for 65 s: nobody"):
        watch.until_done(NoView())  # type: ignore[arg-type]


def test_messages_of_another_session_and_broken_ones_are_passed_over(tmp_path: Path) -> None:
    network = FakeNetwork()
    bus = FakeBus(network)
    stage = Stage(tmp_path)
    watch = RunWatch(bus.subscribe([topics.TRACKED_FRAME]), stage.run.progress, lambda: None, SESSION)
    payload = encode(topics.TRACKED_FRAME, _tracked(1))
    for session, data in (("another", payload), (SESSION, payload[:-3]), (SESSION, payload)):
        bus.publish(topics.TRACKED_FRAME, data, Envelope(session, 4, 1))
    assert stage.run.progress.frames == 0
    while watch.step(0.0):
        pass
    assert stage.run.progress.frames == 5
