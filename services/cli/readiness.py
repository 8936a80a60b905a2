# SPDX-License-Identifier: Apache-2.0
"""Waits until every service has told on the bus that it lives."""

import threading
import time
from collections.abc import Callable, Collection

from services.runtime.errors import KinemapError

_LOOK_EVERY_S = 0.2


class NotReadyError(KinemapError):
    """Somebody has not come up in time."""


class Readiness:
    """`on_change` is for `Bus.watch_alive`."""

    def __init__(self, names: Collection[str]) -> None:
        self._awaited = frozenset(names)
        self._alive: set[str] = set()
        self._changed = threading.Condition()

    def on_change(self, name: str, alive: bool) -> None:
        """Somebody came or went."""
        with self._changed:
            (self._alive.add if alive else self._alive.discard)(name)
            self._changed.notify_all()

    def wait(self, within_s: float, failure: Callable[[], KinemapError | None]) -> None:
        """Return when all are alive at once.

        Raises what `failure` gives, or NotReadyError with the names of those who are missing after `within_s`.
        """
        give_up_s = time.monotonic() + within_s
        while True:
            with self._changed:
                if self._awaited <= self._alive:
                    return
                self._changed.wait(_LOOK_EVERY_S)
                missing = ", ".join(sorted(self._awaited - self._alive))
            if not missing:
                return
            error = failure()
            if error is not None:
                raise error
            if time.monotonic() > give_up_s:
                raise NotReadyError(f"not ready within {within_s:g} s: {missing}")
