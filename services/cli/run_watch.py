# SPDX-License-Identifier: Apache-2.0
"""Listens to a run until it is over: done, given up, or stuck."""

import time
from collections.abc import Callable

from schemas import topics
from schemas.codec import decode
from services.cli.progress_view import ProgressView
from services.cli.run_progress import RunProgress
from services.runtime.bus import Subscription
from services.runtime.errors import KinemapError, ProtocolError

WATCHED_TOPICS = (topics.HEARTBEAT, topics.TRACKED_FRAME, topics.DENSITY)
_LOOK_EVERY_S = 1.0
_SHOW_EVERY_S = 0.2


class StuckError(KinemapError):
    """No service has done anything for too long."""


class RunWatch:
    """Feeds a RunProgress from the bus and looks after the services meanwhile.

    `failure` gives the error of a service that has given up for good, else None; `clock` is any steady clock, in s.
    """

    def __init__(
        self,
        subscription: Subscription,
        progress: RunProgress,
        failure: Callable[[], KinemapError | None],
        session: str,
        *,
        stuck_after_s: float = 180.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._subscription = subscription
        self._progress = progress
        self._failure = failure
        self._session = session
        self._stuck_after_s = stuck_after_s
        self._clock = clock
        self._looked_s = self._shown_s = -1e9

    def until_done(self, view: ProgressView) -> None:
        """Return when the camera says that everything was answered.

        Raises what `failure` gives, or StuckError when nothing has changed for `stuck_after_s`.
        """
        started_s = self._clock()
        while not self._progress.done:
            self.step(0.1)
            now_s = self._clock()
            if now_s - self._shown_s >= _SHOW_EVERY_S:
                self._shown_s = now_s
                view.show(self._progress, now_s)
            if now_s - self._looked_s >= _LOOK_EVERY_S:
                self._looked_s = now_s
                self._look(now_s, started_s)
        view.show(self._progress, self._clock())

    def step(self, timeout_s: float) -> bool:
        """Take one message if one comes within `timeout_s`; false when none did."""
        message = self._subscription.receive(timeout_s)
        if message is None:
            return False
        if message.envelope.session == self._session:
            try:
                record = decode(message.topic, message.payload)
            except ProtocolError:
                return True  # its receiver counts it; here it is only a missing tick of the bar
            self._progress.add(message.envelope.sequence, record, self._clock())
        return True

    def _look(self, now_s: float, started_s: float) -> None:
        error = self._failure()
        if error is not None:
            raise error
        since_s = now_s - (started_s if self._progress.last_change_s is None else self._progress.last_change_s)
        if since_s > self._stuck_after_s:
            raise StuckError(
                f"nothing has gone on for {since_s:.0f} s: {self._progress.waiting_for()}; see the logs of the run"
            )
