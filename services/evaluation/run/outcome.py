# SPDX-License-Identifier: Apache-2.0
"""What a report is told besides the recording, and what it is: light, for who only passes it on."""

from dataclasses import dataclass, field
from typing import Any

Report = dict[str, Any]
"""What report.json holds"""


@dataclass
class ServiceUsage:
    """What the heartbeats of one service said over a run; `metrics` are the last ones."""

    peak_memory_bytes: int = 0
    starts: int = 0
    metrics: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class RunOutcome:
    """How the run itself went; `failure` is the one line of what ended it early, empty where nothing did."""

    session: str = ""
    failure: str = ""
    wall_s: float | None = None
    """from starting the services to the last answer"""
    driven_s: float | None = None
    """from the first frame to the last"""
    every_frame: bool = True
    """whether every frame of the input has to be recorded and answered (lossless)"""
