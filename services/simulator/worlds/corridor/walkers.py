# SPDX-License-Identifier: Apache-2.0
"""People in the corridor: two files that walk round the loop, on the right of their way as people do.

Within a file nobody overtakes: who comes close to the one ahead slows down, and everybody stops for a while now and
then. Times go forward only, so that a longer drive begins as a shorter one does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import SpeedProfile

Floats = NDArray[np.float64]

LANE_M = 0.85
"""How far a file keeps from the corridor's centre."""
_STEP_S = 0.1
_GAP_M, _REACTION_S, _ACCELERATION = 2.0, 0.8, 1.5
"""The gap is counted along the centre; on the inside of a corner it shrinks to a third."""
_STOP_EVERY_S, _STOP_FOR_S = 35.0, (1.5, 5.0)


@dataclass(frozen=True, slots=True)
class Walk:
    """One walker: begins `s_m` along its file's way."""

    s_m: float
    speed: SpeedProfile


def file_of_walkers(rng: np.random.Generator, count: int, length_m: float, duration_s: float) -> list[Walk]:
    """`count` walkers on a loop of `length_m`: where each begins, and how fast it goes over time."""
    if not count:
        return []
    room = length_m / count
    start = np.sort((np.arange(count) + rng.uniform(0.0, 0.4, count)) * room)
    wanted = rng.uniform(0.8, 1.6, count)
    streams = rng.spawn(count)
    next_stop = np.array([stream.exponential(_STOP_EVERY_S) for stream in streams])
    stop_until = np.zeros(count)
    position, speed = start.copy(), wanted.copy()
    speeds = [speed.copy()]
    for step in range(int(np.ceil(duration_s / _STEP_S)) + 1):
        now = step * _STEP_S
        for index in np.flatnonzero(next_stop <= now):
            stop_until[index] = now + streams[index].uniform(*_STOP_FOR_S)
            next_stop[index] = stop_until[index] + streams[index].exponential(_STOP_EVERY_S)
        gap = (np.roll(position, -1) - position) % length_m if count > 1 else np.full(1, length_m)
        follow = np.maximum(gap - _GAP_M, 0.0) / _REACTION_S
        target = np.minimum(np.where(now < stop_until, 0.0, wanted), follow)
        change = np.clip(target - speed, -2.0 * _ACCELERATION * _STEP_S, _ACCELERATION * _STEP_S)
        before, speed = speed, np.maximum(speed + change, 0.0)
        position = position + 0.5 * (before + speed) * _STEP_S
        speeds.append(speed.copy())
    times = np.arange(len(speeds)) * _STEP_S
    table = np.array(speeds)
    return [
        Walk(float(start[k]), SpeedProfile(list(zip(times.tolist(), table[:, k].tolist(), strict=True))))
        for k in range(count)
    ]
