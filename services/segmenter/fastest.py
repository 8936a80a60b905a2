# SPDX-License-Identifier: Apache-2.0
"""The fastest way to run a network on this machine that finds the same as the exact one: measured once."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from services.runtime.log import get_logger
from services.segmenter.agreement import overlaps, sample_image
from services.segmenter.measured_ways import MeasuredWay, best_way, remember, remembered
from services.segmenter.solov2.instances import SegmentedInstances

_RUNS: Final = 3
_log = get_logger("segmenter")


class _Inference(Protocol):
    def segment(self, image: npt.NDArray[np.uint8], /) -> SegmentedInstances: ...


def fastest(key: str, ways: Mapping[str, Callable[[], _Inference]], asked: Sequence[str]) -> str:
    """The name of the fastest of the ways that are asked for.

    Args:
        key: all that times and masks depend on: weights, size, processor, threads, versions. What was measured under
            it before is taken, so that a later run computes the same way.
        ways: makes each, by name; the first is the exact one, which the others must agree with.
        asked: names, the one to fall back on first.
    """
    measured = remembered(key)
    if any(name not in measured for name in ways):
        measured = _measured(ways)
        remember(key, measured)
    for name, way in measured.items():
        if way.fault and name in asked:
            _log.warning("way_left_out", way=name, why=way.fault)
    return best_way(measured, asked)


def _measured(ways: Mapping[str, Callable[[], _Inference]]) -> dict[str, MeasuredWay]:
    image = sample_image()
    exact: SegmentedInstances | None = None
    measured = {}
    for name, make in ways.items():
        try:
            inference = make()
            found = inference.segment(image)
            took_ms = _milliseconds(inference, image)
        except Exception as error:
            if exact is None:
                raise
            # what a library that need not be there raises is its own affair
            _log.warning("way_does_not_run", way=name, error=str(error).splitlines()[0] if str(error) else repr(error))
            measured[name] = MeasuredWay(None, None)
            continue
        least_iou = 1.0 if exact is None else min(overlaps(exact, found), default=None)
        exact = exact or found
        measured[name] = MeasuredWay(took_ms, None if least_iou is None else round(least_iou, 4))
        _log.info("way_measured", way=name, ms=took_ms, least_iou=measured[name].least_iou)
    return measured


def _milliseconds(inference: _Inference, image: npt.NDArray[np.uint8]) -> float:
    times = []
    for _ in range(_RUNS):
        begun = time.perf_counter()
        inference.segment(image)
        times.append(time.perf_counter() - begun)
    return round(1e3 * min(times), 1)
