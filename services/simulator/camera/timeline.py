# SPDX-License-Identifier: Apache-2.0
"""Which frames come, which show the one before once more, and which are black."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.options import MAX_DRIVE_M, DriveOptions

_MISSING, _FROZEN = 101, 102
_MAX_TIMES = 20_000


class Timeline:
    """Frame numbers and what becomes of them; a longer drive begins like a shorter one.

    Raises:
        InputError: so many frames are missing that the drive has no end, or a farther one than worlds reach.
    """

    def __init__(self, options: DriveOptions) -> None:
        self._options = options
        self._slot = _slots_that_come(options)
        frozen = np.random.default_rng([options.seed, _FROZEN]).random(options.frames) < options.frozen_frames
        frozen[0] = False
        # The last frame before it, or itself, that was new.
        self._shown = np.maximum.accumulate(np.where(frozen, 0, np.arange(options.frames)))

    @property
    def times(self) -> int:
        """Frame times until the last frame, those of missing frames included."""
        return int(self._slot[-1]) + 1

    def timestamp_ns(self, index: int) -> int:
        """Capture time of a frame, nanoseconds since the start."""
        return self._options.timestamp_ns(int(self._slot[index]))

    def shown(self, index: int) -> int:
        """The frame whose image is seen."""
        return int(self._shown[index])

    def is_black(self, index: int) -> bool:
        """Whether no light reaches the sensor."""
        start = self._options.blackout_start
        return start <= index < start + self._options.blackout_frames


def _slots_that_come(options: DriveOptions) -> NDArray[np.int64]:
    """Number of the frame time of each frame."""
    if options.missing_frames == 0.0:
        return np.arange(options.frames)
    missing = np.random.default_rng([options.seed, _MISSING]).random(_MAX_TIMES) < options.missing_frames
    missing[0] = False
    slots = np.flatnonzero(~missing)[: options.frames]
    given = f"frames={options.frames} with missing_frames={options.missing_frames}"
    if (int(slots[-1]) + 1) / options.rate_hz * options.speed_m_s > MAX_DRIVE_M:
        raise InputError(f"simulator {given}: expected a drive of at most {MAX_DRIVE_M:g} m")
    if len(slots) < options.frames:
        raise InputError(f"simulator {given}: expected at most {_MAX_TIMES} frame times")
    return slots
