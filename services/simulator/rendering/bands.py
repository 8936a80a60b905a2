# SPDX-License-Identifier: Apache-2.0
"""Work on an image in bands of rows, by several threads where there are several cores."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property

_BAND_PX = 32768
"""Pixels worked on at a time, so that intermediate results stay in the processor's cache."""


class Bands:
    """Runs a step on each band of an image. Bands do not depend on the number of threads, so neither do the bytes."""

    def __init__(self, threads: int) -> None:
        cores = len(os.sched_getaffinity(0))
        self.threads = min(threads or cores, cores)

    def run(self, step: Callable[[slice], None], rows: int, columns: int) -> None:
        """Call `step` with slices of rows that together are all of an image of `rows` by `columns`."""
        height = max(1, _BAND_PX // max(columns, 1))
        bands = [slice(row, row + height) for row in range(0, rows, height)]
        if self.threads == 1 or len(bands) == 1:
            for band in bands:
                step(band)
        else:
            list(self._pool.map(step, bands))

    @cached_property
    def _pool(self) -> ThreadPoolExecutor:
        # Made when it is first needed: a process that only builds the world may still fork.
        return ThreadPoolExecutor(self.threads, thread_name_prefix="shade")
