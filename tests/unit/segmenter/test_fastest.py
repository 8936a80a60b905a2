# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from services.segmenter import fastest as module
from services.segmenter.fastest import fastest


class _Clock:
    now = 0.0

    def perf_counter(self) -> float:
        return self.now


class _Takes:
    """Takes so long by the clock."""

    def __init__(self, clock: _Clock, seconds: float) -> None:
        self._clock, self._seconds = clock, seconds
        self.runs = 0

    def segment(self, image: npt.NDArray[np.uint8]) -> None:
        assert image.shape == (48, 96, 3)
        self.runs += 1
        self._clock.now += self._seconds


@pytest.fixture
def clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> _Clock:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    clock = _Clock()
    monkeypatch.setattr(module, "time", clock)
    return clock


def test_the_fastest_is_taken_and_remembered(clock: _Clock) -> None:
    slow, quick = _Takes(clock, 0.3), _Takes(clock, 0.1)
    assert fastest("one", {"fp32": slow, "bf16": quick}, (96, 48)) == "bf16"
    assert quick.runs > 0
    swapped = {"fp32": _Takes(clock, 0.1), "bf16": _Takes(clock, 0.3)}
    assert fastest("one", swapped, (96, 48)) == "bf16"
    assert swapped["fp32"].runs == 0
    assert fastest("another machine", swapped, (96, 48)) == "fp32"


def test_the_exact_way_is_left_only_for_a_gain_that_is_worth_it(clock: _Clock) -> None:
    assert fastest("one", {"fp32": _Takes(clock, 0.11), "bf16": _Takes(clock, 0.1)}, (96, 48)) == "fp32"


def test_what_is_not_as_it_was_written_is_measured_again(clock: _Clock, tmp_path: Path) -> None:
    path = tmp_path / "kinemap" / "weights" / "fastest.json"
    for content in ("{", "[]", '{"one": 3}', '{"one": {"fp32": "a", "bf16": 1.0}}'):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
        assert fastest("one", {"fp32": _Takes(clock, 0.3), "bf16": _Takes(clock, 0.1)}, (96, 48)) == "bf16"
