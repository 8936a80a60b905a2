# SPDX-License-Identifier: Apache-2.0
"""What the two ways to deliver stand on, and what they are to the camera service."""

import threading
from typing import NamedTuple, Protocol

from schemas.topics import Topic
from services.camera.sources.source import SourceFrame


class Parcel(NamedTuple):
    """The encoded messages of one frame, or of the end of input: sent again they are the same bytes."""

    sequence: int
    timestamp_ns: int
    messages: tuple[tuple[Topic, bytes], ...]


class Outlet(Protocol):
    """Where frames go."""

    def pack(self, sequence: int, frame: SourceFrame) -> Parcel:
        """One frame's messages, the manifest first."""

    def pack_end(self, frame_count: int, timestamp_ns: int) -> Parcel:
        """The end of input, under the sequence number `frame_count`."""

    def send(self, parcel: Parcel) -> None:
        """Onto the bus."""


class Host(Protocol):
    """The process: it is told how far the camera is, and says when to stop."""

    stopping: threading.Event
    state: str
    sequence: int


class Delivery(Protocol):
    """Decides what is sent when. Knows no bus and no clock; called from one thread."""

    @property
    def ended(self) -> bool:
        """Whether there is nothing left to do."""

    @property
    def done(self) -> int:
        """The last frame that is done; -1 before the first."""

    @property
    def sent_again(self) -> int:
        """How often something was sent again."""

    @property
    def wants_frame(self) -> bool:
        """Whether the next frame is to be offered."""

    def offer(self, frame: SourceFrame | None, now_s: float) -> None:
        """Take the next frame, or the word that there is none left."""

    def step(self, now_s: float) -> float:
        """Send what is due; in how many seconds to come back if nothing happens before."""

    def answered(self, service: str, sequence: int) -> None:
        """A service has done its part of a frame."""

    def service_came(self, now_s: float) -> None:
        """A service came back: it has missed what is on its way."""

    def waiting_for(self) -> str:
        """Who owes which answer, for people."""
