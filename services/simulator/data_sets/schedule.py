# SPDX-License-Identifier: Apache-2.0
"""Which frames are rendered next, and by whom: a world takes seconds to build, so a worker stays with its own."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Mapping, Sequence
from typing import NamedTuple

CHUNK_FRAMES = 8


class Chunk(NamedTuple):
    """A few frames of one sequence."""

    sequence: str
    indices: tuple[int, ...]


class Schedule:
    """Hands the frames out in chunks. `left` are those of each sequence that are not there yet."""

    def __init__(self, left: Mapping[str, Sequence[int]]) -> None:
        self._left = {sequence: deque(indices) for sequence, indices in left.items() if indices}
        self._at: dict[int, str] = {}

    def next_for(self, worker: int) -> Chunk | None:
        """The next frames for a worker; None when there are none left.

        It goes on with the sequence it is at, else begins one that fewest are at, the first of those.
        """
        waiting = [sequence for sequence, indices in self._left.items() if indices]
        if not waiting:
            return None
        sequence = self._at.get(worker)
        if sequence not in waiting:
            busy = Counter(other for number, other in self._at.items() if number != worker)
            sequence = min(waiting, key=lambda name: busy[name])
        self._at[worker] = sequence
        indices = self._left[sequence]
        return Chunk(sequence, tuple(indices.popleft() for _ in range(min(CHUNK_FRAMES, len(indices)))))
