# SPDX-License-Identifier: Apache-2.0
"""Logs: one line an event, in words or as JSON."""

import json

import pytest

from services.runtime.config.log import LogConfig
from services.runtime.log import get_logger, set_up_logging


@pytest.fixture(autouse=True)
def _logging_as_before() -> object:
    import logging

    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    yield
    root.handlers[:] = handlers
    root.setLevel(level)


def test_a_line_has_time_level_service_event_and_fields(capsys: pytest.CaptureFixture[str]) -> None:
    set_up_logging(LogConfig())
    get_logger("motion").info("frame_dropped", sequence=3, reason="too late", text="a\nb")
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith('info motion frame_dropped sequence=3 reason="too late" text="a\\nb"')


def test_json_lines_are_json(capsys: pytest.CaptureFixture[str]) -> None:
    set_up_logging(LogConfig(json_lines=True))
    get_logger("slam").warning("lost", frame=9)
    entry = json.loads(capsys.readouterr().err)
    assert (entry["level"], entry["service"], entry["event"], entry["frame"]) == ("warning", "slam", "lost", 9)


def test_what_is_below_the_level_is_not_written(capsys: pytest.CaptureFixture[str]) -> None:
    set_up_logging(LogConfig(level="warning"))
    get_logger("slam").info("quiet")
    assert capsys.readouterr().err == ""


def test_the_same_warning_comes_once_a_second_at_most(capsys: pytest.CaptureFixture[str]) -> None:
    set_up_logging(LogConfig())
    log = get_logger("slam")
    for _ in range(100):
        log.warning_limited("bad")
    log.warning_limited("other")
    assert len(capsys.readouterr().err.splitlines()) <= 3
