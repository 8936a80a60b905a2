# SPDX-License-Identifier: Apache-2.0
"""Which way is taken: by time, and by what it finds."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import torch

from services.segmenter import fastest as module
from services.segmenter.fastest import fastest
from services.segmenter.measured_ways import ChosenWay, MeasuredWay, remembered_of
from services.segmenter.solov2.instances import SegmentedInstances


class _Clock:
    now = 0.0

    def perf_counter(self) -> float:
        return self.now


class _Takes:
    """Takes so long by the clock and finds one square of so many rows."""

    def __init__(self, clock: _Clock, seconds: float, rows: int = 100) -> None:
        self._clock, self._seconds, self._rows = clock, seconds, rows
        self.runs = 0

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        self.runs += 1
        self._clock.now += self._seconds
        count = 1 if self._rows else 0
        masks = torch.zeros(count, *image.shape[:2], dtype=torch.bool)
        masks[:, : self._rows, :100] = True
        return SegmentedInstances(masks, torch.zeros(count, dtype=torch.int64), torch.full((count,), 0.9))


def _broken() -> _Takes:
    raise OSError("libtbb.so.12: cannot open shared object file\nand so on")


def _made(*ways: _Takes) -> dict[str, Callable[[], _Takes]]:
    return {name: (lambda way=way: way) for name, way in zip(("exact", "second", "third"), ways, strict=False)}


def _warned(caplog: pytest.LogCaptureFixture, event: str) -> object:
    """The fields of the first warning of this name."""
    return next((entry.__dict__["fields"] for entry in caplog.records if entry.getMessage() == event), None)


@pytest.fixture
def clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> _Clock:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    clock = _Clock()
    monkeypatch.setattr(module, "time", clock)
    return clock


def test_the_fastest_is_taken_and_remembered(clock: _Clock) -> None:
    ways = (_Takes(clock, 0.3), _Takes(clock, 0.2), _Takes(clock, 0.1))
    assert fastest("one", _made(*ways), ["exact", "second", "third"], clock.perf_counter) == "third"
    assert all(way.runs > 1 for way in ways)
    swapped = (_Takes(clock, 0.1), _Takes(clock, 0.3), _Takes(clock, 0.3))
    assert fastest("one", _made(*swapped), ["exact", "second", "third"], clock.perf_counter) == "third"
    assert not any(way.runs for way in swapped)
    assert fastest("another machine", _made(*swapped), ["exact", "second", "third"], clock.perf_counter) == "exact"


def test_the_exact_way_is_left_only_for_a_gain_that_is_worth_it(clock: _Clock) -> None:
    assert (
        fastest("one", _made(_Takes(clock, 0.105), _Takes(clock, 0.1)), ["exact", "second"], clock.perf_counter)
        == "exact"
    )


def test_a_way_that_finds_other_masks_is_left_out(clock: _Clock, caplog: pytest.LogCaptureFixture) -> None:
    ways = _made(_Takes(clock, 0.3), _Takes(clock, 0.1, rows=97), _Takes(clock, 0.2, rows=99))
    assert fastest("one", ways, [*ways], clock.perf_counter) == "third"
    assert _warned(caplog, "way_left_out") == {"way": "second", "why": "finds other masks, IoU 0.970"}


def test_where_nothing_is_found_nothing_can_be_judged(clock: _Clock) -> None:
    ways = _made(_Takes(clock, 0.3, rows=0), _Takes(clock, 0.1, rows=0))
    assert fastest("one", ways, [*ways], clock.perf_counter) == "exact"


def test_a_way_that_does_not_run_is_left_out_and_not_tried_again(
    clock: _Clock, caplog: pytest.LogCaptureFixture
) -> None:
    ways = {**_made(_Takes(clock, 0.3), _Takes(clock, 0.2)), "broken": _broken}
    assert fastest("one", ways, [*ways], clock.perf_counter) == "second"
    error = "libtbb.so.12: cannot open shared object file"
    assert _warned(caplog, "way_does_not_run") == {"way": "broken", "error": error}
    caplog.clear()
    assert fastest("one", ways, [*ways], clock.perf_counter) == "second"
    assert _warned(caplog, "way_does_not_run") is None
    assert _warned(caplog, "way_left_out") == {"way": "broken", "why": "does not run here"}
    with pytest.raises(OSError, match="libtbb"):
        fastest("two", {"broken": _broken, **_made(_Takes(clock, 0.2))}, ["broken", "exact"], clock.perf_counter)


def test_of_ways_that_are_asked_for_the_first_is_fallen_back_on(clock: _Clock) -> None:
    ways = _made(_Takes(clock, 0.1), _Takes(clock, 0.3, rows=90), _Takes(clock, 0.2, rows=90))
    assert fastest("one", ways, ["second", "third"], clock.perf_counter) == "second"


def test_no_way_is_begun_after_the_time_allowed(
    clock: _Clock, caplog: pytest.LogCaptureFixture, tmp_path: Path
) -> None:
    ways = (_Takes(clock, 5.0), _Takes(clock, 3.0), _Takes(clock, 0.1))
    assert fastest("one", _made(*ways), ["exact", "second", "third"], clock.perf_counter) == "second"
    assert ways[2].runs == 0
    path = tmp_path / "kinemap" / "weights" / "fastest.json"
    assert _warned(caplog, "ways_not_measured") == {"ways": "third", "measured_again_without": str(path)}
    assert fastest("one", _made(*ways), ["exact", "second", "third"], clock.perf_counter) == "second"
    assert ways[2].runs == 0
    path.unlink()
    quicker = (_Takes(clock, 0.4), _Takes(clock, 0.3), _Takes(clock, 0.1))
    assert fastest("one", _made(*quicker), ["exact", "second", "third"], clock.perf_counter) == "third"


@pytest.mark.parametrize(
    "content",
    [
        "{",
        "[]",
        '{"one": 3}',
        '{"one": {"way": "exact"}}',
        '{"one": {"way": 3, "measured": {}}}',
        '{"one": {"way": "gone", "measured": {}}}',
        '{"one": {"way": "exact", "measured": {"exact": 1.0}}}',
        '{"one": {"way": "exact", "measured": {"exact": {"ms": "a", "least_iou": 1.0}}}}',
    ],
)
def test_what_is_not_as_it_was_written_is_measured_again(clock: _Clock, tmp_path: Path, content: str) -> None:
    path = tmp_path / "kinemap" / "weights" / "fastest.json"
    path.parent.mkdir(parents=True)
    path.write_text(content)
    assert (
        fastest("one", _made(_Takes(clock, 0.3), _Takes(clock, 0.1)), ["exact", "second"], clock.perf_counter)
        == "second"
    )


def test_what_was_chosen_is_told_of_one_model(clock: _Clock) -> None:
    fastest("abc R18", _made(_Takes(clock, 0.3), _Takes(clock, 0.1)), ["exact", "second"], clock.perf_counter)
    fastest(
        "abd R18",
        {**_made(_Takes(clock, 0.3), _Takes(clock, 0.1, rows=50)), "x": _broken},
        ["exact", "second"],
        clock.perf_counter,
    )
    measured = {"exact": MeasuredWay(300.0, 1.0), "second": MeasuredWay(100.0, 1.0)}
    assert remembered_of("abc ") == {"R18": ChosenWay("second", measured)}
    assert remembered_of("x") == {}
    assert str(remembered_of("abd ")["R18"]) == (
        "exact, of exact 300 ms, second 100 ms (left out: finds other masks, IoU 0.500), "
        "x (left out: does not run here)"
    )
