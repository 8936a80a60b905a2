# SPDX-License-Identifier: Apache-2.0
"""How far a run is, as heard on the bus; knows no bus and no screen."""

from collections import deque
from dataclasses import dataclass, field

from schemas.records import Density, Heartbeat, MotionState, TrackedFrame
from services.evaluation.run.outcome import ServiceUsage

_RATE_WINDOW_S = 5.0
_LANDMARKS = "landmarks_"


@dataclass
class RunProgress:
    """Adds up heartbeats, tracked frames and densities. `total` is the input's number of frames, -1: unknown."""

    total: int = -1
    frames: int = 0
    """frames that slam has done"""
    state: str = "starting"
    density: str = "-"
    services: dict[str, ServiceUsage] = field(default_factory=dict)
    done: bool = False
    """the camera's word that every frame was answered by every service that answers"""
    last_change_s: float | None = None
    driven_s: float = 0.0
    """from the first frame heard to the last"""
    _first_s: float | None = None
    _beats: dict[str, Heartbeat] = field(default_factory=dict)
    _furthest: dict[str, int] = field(default_factory=dict)
    _pids: dict[str, set[int]] = field(default_factory=dict)
    _recent: deque[tuple[float, int]] = field(default_factory=deque)

    def add(self, sequence: int, record: object, now_s: float) -> None:
        """Take one record, of frame `sequence`, heard at `now_s` (any steady clock)."""
        match record:
            case Heartbeat():
                self._beat(record, now_s)
            case TrackedFrame() if sequence + 1 > self.frames:
                self.frames = sequence + 1
                self.state = record.state.name.lower()
                self._recent.append((now_s, self.frames))
                self._first_s = now_s if self._first_s is None else self._first_s
                self.driven_s = now_s - self._first_s
                while now_s - self._recent[0][0] > _RATE_WINDOW_S and len(self._recent) > 2:
                    self._recent.popleft()
                self.last_change_s = now_s
            case Density():
                self.density = record.level.name.lower()
            case _:
                pass

    @property
    def frames_per_s(self) -> float:
        """Over the last seconds."""
        if len(self._recent) < 2:
            return 0.0
        (first_s, first), (last_s, last) = self._recent[0], self._recent[-1]
        return (last - first) / (last_s - first_s) if last_s > first_s else 0.0

    @property
    def landmarks(self) -> dict[str, int]:
        """Landmarks by label, as the mapstore last said."""
        beat = self._beats.get("mapstore")
        if beat is None:
            return {}
        labels = (state.name.lower() for state in MotionState)
        return {label: int(beat.metrics[_LANDMARKS + label]) for label in labels if _LANDMARKS + label in beat.metrics}

    def line(self) -> str:
        """All of it in one line."""
        landmarks = " ".join(f"{count} {label}" for label, count in self.landmarks.items() if count) or "no landmarks"
        total = "?" if self.total < 0 else str(self.total)
        return (
            f"{self.frames}/{total} frames, {self.frames_per_s:.1f} fps, {self.state}, {landmarks},"
            f" density {self.density}"
        )

    def waiting_for(self) -> str:
        """Which services are how far: what to say when nothing goes on."""
        return (
            ", ".join(f"{name} {beat.state} at {beat.sequence}" for name, beat in sorted(self._beats.items()))
            or "nobody"
        )

    def _beat(self, beat: Heartbeat, now_s: float) -> None:
        before = self._furthest.get(beat.service, -1)
        # A service that dies and comes back again and again changes its state, and gets nowhere.
        if beat.sequence > before:
            self._furthest[beat.service] = beat.sequence
            self.last_change_s = now_s
        self._beats[beat.service] = beat
        usage = self.services.setdefault(beat.service, ServiceUsage())
        usage.peak_memory_bytes = max(usage.peak_memory_bytes, beat.peak_memory_bytes)
        pids = self._pids.setdefault(beat.service, set())
        pids.add(beat.pid)
        usage.starts = len(pids)
        usage.metrics = dict(beat.metrics)
        if beat.service == "camera":
            self.done = beat.state == "done"
