# SPDX-License-Identifier: Apache-2.0
"""The fastest way to run a network on this machine that finds the same as the exact one: measured once."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from services.runtime.log import get_logger
from services.segmenter.agreement import overlaps, sample_images
from services.segmenter.measured_ways import ChosenWay, MeasuredWay, best_way, choices_path, remember, remembered
from services.segmenter.solov2.instances import SegmentedInstances

_ALLOWED_S: Final = 30.0
"""after which no further way is begun: whoever starts the services waits for this one for a minute at most"""
_log = get_logger("segmenter")


class _Inference(Protocol):
    def segment(self, image: npt.NDArray[np.uint8], /) -> SegmentedInstances: ...


def fastest(
    key: str, ways: Mapping[str, Callable[[], _Inference]], asked: Sequence[str], clock: Callable[[], float]
) -> str:
    """The name of the fastest of the ways that are asked for.

    Args:
        key: all that the choice depends on: what is asked for, weights, size, processor, threads, versions. What was
            chosen under it before is taken, so that a later run computes the same way.
        ways: makes each, by name; the first is the exact one, which the others must agree with. Those that the time
            allowed for a start does not suffice for are left out.
        asked: names, the one to fall back on first.
        clock: gives the seconds to judge by. On a processor those of the processor: the other services start at the
            same time, and how busy they keep it must decide nothing.
    """
    choice = remembered(key)
    if choice is None or choice.name not in asked:
        measured = _measured(ways, clock)
        choice = ChosenWay(best_way(measured, asked), measured)
        remember(key, choice)
    for name, way in choice.measured.items():
        if way.fault and name in asked:
            _log.warning("way_left_out", way=name, why=way.fault)
    return choice.name


def _measured(ways: Mapping[str, Callable[[], _Inference]], clock: Callable[[], float]) -> dict[str, MeasuredWay]:
    images = sample_images()
    exact: list[SegmentedInstances] = []
    measured: dict[str, MeasuredWay] = {}
    begun = time.perf_counter()
    for name, make in ways.items():
        if time.perf_counter() - begun > _ALLOWED_S:
            left = ", ".join(other for other in ways if other not in measured)
            _log.warning("ways_not_measured", ways=left, measured_again_without=str(choices_path()))
            break
        try:
            found, took_ms = _run(make(), images, clock)
        except Exception as error:
            if not exact:
                raise
            # what a library that need not be there raises is its own affair
            _log.warning("way_does_not_run", way=name, error=str(error).partition("\n")[0] or repr(error))
            measured[name] = MeasuredWay(None, None)
            continue
        exact = exact or found
        ious = [iou for one, other in zip(exact, found, strict=True) for iou in overlaps(one, other)]
        measured[name] = MeasuredWay(took_ms, round(min(ious), 4) if ious else None)
        _log.info("way_measured", way=name, ms=took_ms, least_iou=measured[name].least_iou, instances=len(ious))
    return measured


def _run(
    inference: _Inference, images: Sequence[npt.NDArray[np.uint8]], clock: Callable[[], float]
) -> tuple[list[SegmentedInstances], float]:
    """What is found in each, and the milliseconds of the quickest: the first one also gets everything ready."""
    found, times = [], []
    for image in images:
        begun = clock()
        found.append(inference.segment(image))
        times.append(clock() - begun)
    return found, round(1e3 * min(times), 1)
