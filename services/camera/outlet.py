# SPDX-License-Identifier: Apache-2.0
"""What the two ways to deliver stand on, and what they are to the camera service."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

from schemas.topics import Topic
from services.camera.sources.source import SourceFrame

NextFrame = Callable[[], SourceFrame | None]
"""The frames in order; None at the end."""


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

    def step(self, now_s: float) -> float:
        """Send what is to be sent now; in how many seconds to come back if nothing happens before."""

    def answered(self, service: str, sequence: int) -> None:
        """A service has done its part of a frame."""

    def service_came(self, now_s: float) -> None:
        """A service came back: it has missed what is on its way."""

    def waiting_for(self) -> str:
        """Who owes which answer, for people."""
