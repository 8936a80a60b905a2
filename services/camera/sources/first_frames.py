# SPDX-License-Identifier: Apache-2.0
"""The beginning of another source."""

from services.camera.sources.source import Source, SourceFrame


class FirstFrames:
    """The first `count` frames of `source`, or all of it where it is shorter."""

    def __init__(self, source: Source, count: int) -> None:
        self._source = source
        self._count = count

    @property
    def name(self) -> str:
        return self._source.name

    @property
    def frame_count(self) -> int:
        known = self._source.frame_count
        return self._count if known < 0 else min(known, self._count)

    @property
    def rate_hz(self) -> float:
        return self._source.rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return (*self._source.notes, f"only the first {self._count} frames")

    def frame(self, index: int) -> SourceFrame | None:
        return self._source.frame(index) if index < self._count else None

    def close(self) -> None:
        self._source.close()
