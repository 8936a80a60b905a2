# SPDX-License-Identifier: Apache-2.0
"""What a service has already said, and the state it said it from: memory of a frame that a kill -9 does not erase.

A frame that is sent again gets the same bytes again from here instead of being processed twice, so a service that was
killed goes on exactly where it was (the transactional outbox pattern).
"""

from collections import OrderedDict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from schemas.topics import BY_KEY, Topic
from services.runtime.envelope import Envelope
from services.runtime.errors import ResourceError

State = dict[str, npt.NDArray[np.generic]]


class Sent(NamedTuple):
    """What a service sent for one frame."""

    envelope: Envelope
    messages: tuple[tuple[Topic, bytes], ...]


class Outbox:
    """What was sent for the last `depth` frames; with `folder`, on disk too, together with the state."""

    def __init__(self, depth: int, folder: Path | None) -> None:
        self._depth = depth
        self._folder = folder
        self._sent: OrderedDict[int, Sent] = OrderedDict()
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)

    def get(self, sequence: int) -> Sent | None:
        """What was sent for a frame, or None when that is too long ago or never happened."""
        return self._sent.get(sequence)

    def record(self, sent: Sent, state: State | None) -> None:
        """Remember a frame, then the state after it. Raises ResourceError when the disk does not take it."""
        sequence = sent.envelope.sequence
        self._sent[sequence] = sent
        gone = [old for old in self._sent if old <= sequence - self._depth]
        for old in gone:
            del self._sent[old]
        if self._folder is None or state is None:
            return
        try:
            self._write(self._frame_file(sequence), _pack(sent))
            self._write(self._folder / "state.npz", {**state, "__sequence": np.array(sequence, dtype=np.int64)})
            for old in gone:
                self._frame_file(old).unlink(missing_ok=True)
        except OSError as error:
            raise ResourceError(f"state folder {self._folder} cannot be written: {error.strerror}") from error

    def restore(self, session: str) -> tuple[int, State] | None:
        """The last frame's sequence number and the state after it, as a killed predecessor left them."""
        if self._folder is None or not (self._folder / "state.npz").exists():
            return None
        with np.load(self._folder / "state.npz", allow_pickle=False) as archive:
            state = {name: archive[name] for name in archive.files}
        sequence = int(state.pop("__sequence"))
        for old in range(max(0, sequence - self._depth + 1), sequence + 1):
            if self._frame_file(old).exists():
                with np.load(self._frame_file(old), allow_pickle=False) as archive:
                    self._sent[old] = _unpack(session, {name: archive[name] for name in archive.files})
        return sequence, state

    def _frame_file(self, sequence: int) -> Path:
        assert self._folder is not None
        return self._folder / f"frame-{sequence}.npz"

    @staticmethod
    def _write(path: Path, arrays: State) -> None:
        part = path.with_suffix(".part")
        with part.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
        part.replace(path)


def _pack(sent: Sent) -> State:
    arrays: State = {"__frame": np.array([sent.envelope.sequence, sent.envelope.timestamp_ns], dtype=np.int64)}
    for index, (topic, payload) in enumerate(sent.messages):
        arrays[f"{index}:{topic.key.replace('/', ':')}"] = np.frombuffer(payload, dtype=np.uint8)
    return arrays


def _unpack(session: str, arrays: State) -> Sent:
    sequence, timestamp_ns = (int(value) for value in arrays.pop("__frame"))
    numbered = sorted((int(name.split(":", 1)[0]), name) for name in arrays)
    messages = tuple((BY_KEY[name.split(":", 1)[1].replace(":", "/")], arrays[name].tobytes()) for _, name in numbered)
    return Sent(Envelope(session, sequence, timestamp_ns), messages)
