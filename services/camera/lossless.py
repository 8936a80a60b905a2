# SPDX-License-Identifier: Apache-2.0
"""`lossless` as the camera sees it: send within the window, send again what stays unanswered, end when all is done."""

from services.camera.delivery import Outlet, Parcel
from services.camera.position import Position, PositionFile
from services.camera.sources.source import SourceFrame
from services.runtime.frame_window import FrameWindow


class LosslessDelivery:
    """Sends frame n when everyone has answered up to n - W, and the end of input when everyone has answered all.

    Offered are the frames from the one after the saved position on.

    Args:
        window: fresh, its first sequence the one after the saved position.
        position_file: where a predecessor was, and where this one is saved.
        outlet: packs and sends.
    """

    def __init__(self, window: FrameWindow, position_file: PositionFile, outlet: Outlet) -> None:
        self._window = window
        self._file = position_file
        self._outlet = outlet
        self._position = position_file.read()
        self._last_timestamp_ns = self._position.timestamp_ns
        self._kept: dict[int, Parcel] = {}
        self._frames_over = False
        self._end_sequence: int | None = None
        self._sent_again = 0

    @property
    def ended(self) -> bool:
        """Whether every frame and the end of input are answered by everyone."""
        return self._position.ended

    @property
    def done(self) -> int:
        """The last frame up to which everything is answered by everyone; -1 before the first."""
        return self._position.sequence

    @property
    def sent_again(self) -> int:
        """How often a frame was sent again."""
        return self._sent_again

    @property
    def wants_frame(self) -> bool:
        """Whether the next frame may go."""
        return not self._frames_over and self._window.may_send

    def offer(self, frame: SourceFrame | None, now_s: float) -> None:
        """Send the next frame; None when there is none left."""
        if frame is None:
            self._frames_over = True
        else:
            self._send_first(self._outlet.pack(self._window.next_sequence, frame), now_s)

    def step(self, now_s: float) -> float:
        """Send again what is overdue, and the end if it may go; in how many seconds to come back."""
        for sequence in self._window.overdue(now_s):
            self._outlet.send(self._kept[sequence])
            self._sent_again += 1
        if self._frames_over and self._end_sequence is None and not self._window.in_flight:
            # Only when all frames are done everywhere: then nobody has to hold the end back behind a late frame.
            self._end_sequence = self._window.next_sequence
            self._send_first(self._outlet.pack_end(self._end_sequence, self._last_timestamp_ns + 1), now_s)
        due_s = self._window.next_due_s()
        return 0.0 if self.wants_frame or due_s is None else max(0.0, due_s - now_s)

    def answered(self, service: str, sequence: int) -> None:
        """A service has done its part of a frame."""
        if not self._window.answered(service, sequence):
            return
        finished = [kept for kept in self._kept if kept <= self._window.done]
        if not finished:
            return
        last = self._kept[finished[-1]]
        for kept in finished:
            del self._kept[kept]
        if last.sequence == self._end_sequence:
            self._position = self._position._replace(ended=True)
        else:
            self._position = Position(last.sequence, last.timestamp_ns)
        self._file.save(self._position)

    def service_came(self, now_s: float) -> None:
        """A service came back: everything on its way is due again."""
        self._window.expire(now_s)

    def waiting_for(self) -> str:
        """Who owes which answer: `recorder 3-10, slam 9-10`."""
        owed: dict[str, list[int]] = {}
        for sequence in self._window.in_flight:
            for service in self._window.missing(sequence):
                owed.setdefault(service, []).append(sequence)
        return ", ".join(f"{service} {frames[0]}-{frames[-1]}" for service, frames in sorted(owed.items()))

    def _send_first(self, parcel: Parcel, now_s: float) -> None:
        self._last_timestamp_ns = parcel.timestamp_ns
        self._kept[parcel.sequence] = parcel
        self._window.sent(parcel.sequence, now_s)
        self._outlet.send(parcel)
