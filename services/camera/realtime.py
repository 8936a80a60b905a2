# SPDX-License-Identifier: Apache-2.0
"""`realtime` as the camera sees it: frames leave at the pace at which they were captured, and nobody is waited for."""

from services.camera.delivery import Outlet, Parcel
from services.camera.pacing import AsTheyCome, Pacing
from services.camera.position import Position, PositionFile
from services.camera.sources.source import SourceFrame
from services.runtime.frame_window import FrameWindow

_END_PATIENCE_S = 30.0


class RealtimeDelivery:
    """Sends each frame once, when its time has come. Only the end of input is sent until it is answered.

    Offered are the frames from the one after the saved position on.

    Args:
        end_window: of the end of input alone, its first sequence 0.
        position_file: where a predecessor was, and where this one is saved.
        outlet: packs and sends.
        pacing: when a frame's time has come.
    """

    def __init__(
        self, end_window: FrameWindow, position_file: PositionFile, outlet: Outlet, pacing: Pacing | AsTheyCome
    ) -> None:
        self._end_window = end_window
        self._file = position_file
        self._outlet = outlet
        self._position = position_file.read()
        self._pacing = pacing
        self._waiting: SourceFrame | None = None
        self._end: Parcel | None = None
        self._give_up_s = 0.0
        self._sent_again = 0

    @property
    def ended(self) -> bool:
        """Whether the end of input is answered by everyone, or was waited for long enough."""
        return self._position.ended

    @property
    def done(self) -> int:
        """The last frame sent; -1 before the first."""
        return self._position.sequence

    @property
    def sent_again(self) -> int:
        """How often the end of input was sent again."""
        return self._sent_again

    @property
    def wants_frame(self) -> bool:
        """Whether the frame before has left."""
        return self._waiting is None and self._end is None

    def offer(self, frame: SourceFrame | None, now_s: float) -> None:
        """Hold the next frame until its time has come; None when there is none left."""
        self._waiting = frame
        if frame is None:
            self._end = self._outlet.pack_end(self.done + 1, self._position.timestamp_ns + 1)
            self._give_up_s = now_s + _END_PATIENCE_S
            self._end_window.sent(0, now_s)
            self._outlet.send(self._end)

    def step(self, now_s: float) -> float:
        """Send what has its time now; in how many seconds to come back."""
        if self._end is not None:
            return self._see_to_end(self._end, now_s)
        if self._waiting is None:
            return 0.0
        wait_s = self._pacing.wait_s(self._waiting.timestamp_ns, now_s)
        if wait_s == 0.0:
            self._outlet.send(self._outlet.pack(self.done + 1, self._waiting))
            self._save(Position(self.done + 1, self._waiting.timestamp_ns))
            self._waiting = None
        return wait_s

    def answered(self, service: str, sequence: int) -> None:
        """A service has done its part; only the end's answers count."""
        if self._end is not None and sequence == self._end.sequence:
            self._end_window.answered(service, 0)
            if not self._end_window.in_flight:
                self._save(self._position._replace(ended=True))

    def service_came(self, now_s: float) -> None:
        """A service came back: it goes on with the newest frame, and hears of the end again."""
        self._end_window.expire(now_s)

    def waiting_for(self) -> str:
        """Who has not answered the end of input: `recorder, slam`."""
        return ", ".join(sorted(self._end_window.missing(0)))

    def _see_to_end(self, end: Parcel, now_s: float) -> float:
        if now_s >= self._give_up_s:
            self._save(self._position._replace(ended=True))
            return 0.0
        if self._end_window.overdue(now_s):
            self._outlet.send(end)
            self._sent_again += 1
        due_s = self._end_window.next_due_s()
        return 0.0 if due_s is None else max(0.0, due_s - now_s)

    def _save(self, position: Position) -> None:
        self._position = position
        self._file.save(position)
