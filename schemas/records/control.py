# SPDX-License-Identifier: Apache-2.0
"""How services tell each other that they live and what they have done."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class FrameAnswer:
    """The credit of `lossless`: this service has done its part of the frame."""

    timestamp_ns: int
    service: str


@dataclass(frozen=True)
class Heartbeat:
    """Once a second from every service. `sequence` is the last frame done, -1 for none yet."""

    service: str
    pid: int
    state: str
    """starting, running, draining or done"""
    sequence: int
    peak_memory_bytes: int
    metrics: dict[str, float] = field(default_factory=dict)
