# SPDX-License-Identifier: Apache-2.0
"""Counters and durations of one service, reported in its heartbeat."""

import threading
from collections import Counter, defaultdict, deque

import numpy as np

_KEPT = 20_000
"""durations kept a stage: enough for exact percentiles of half an hour at 10 Hz"""


class Metrics:
    """Thread-safe; names are plain words, durations in milliseconds."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()
        self._most: dict[str, float] = {}
        self._durations: defaultdict[str, deque[float]] = defaultdict(lambda: deque(maxlen=_KEPT))

    def count(self, name: str, by: int = 1) -> None:
        """Add to a counter."""
        with self._lock:
            self._counts[name] += by

    def at_most(self, name: str, value: float) -> None:
        """Keep the largest of the values that a name is given."""
        with self._lock:
            self._most[name] = max(self._most.get(name, value), value)

    def observe_ms(self, name: str, ms: float) -> None:
        """Add one duration of a stage."""
        with self._lock:
            self._durations[name].append(ms)

    def values(self) -> dict[str, float]:
        """Every counter by its name, every stage as `<stage>_ms_p50` and `<stage>_ms_p95`."""
        with self._lock:
            values: dict[str, float] = {name: float(count) for name, count in self._counts.items()} | self._most
            for stage, durations in self._durations.items():
                p50, p95 = np.percentile(np.fromiter(durations, dtype=np.float64), (50, 95))
                values[f"{stage}_ms_p50"], values[f"{stage}_ms_p95"] = float(p50), float(p95)
        return values
