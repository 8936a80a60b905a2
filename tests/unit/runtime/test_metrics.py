# SPDX-License-Identifier: Apache-2.0
"""Counters and percentiles."""

from services.runtime.metrics import Metrics


def test_counts_and_percentiles() -> None:
    metrics = Metrics()
    for ms in range(101):
        metrics.observe_ms("process", float(ms))
    metrics.count("frames")
    metrics.count("frames", by=2)
    assert metrics.values() == {"frames": 3.0, "process_ms_p50": 50.0, "process_ms_p95": 95.0}
