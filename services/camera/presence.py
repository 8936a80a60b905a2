# SPDX-License-Identifier: Apache-2.0
"""Which of the services that the camera needs are there."""

import threading
from collections.abc import Collection


class Presence:
    """Told from the bus's thread, asked from the camera's."""

    def __init__(self, needed: Collection[str]) -> None:
        self._missing = set(needed)
        self._needed = frozenset(needed)
        self._came = False
        self._changed = threading.Condition()

    def changed(self, name: str, alive: bool) -> None:
        """A service came or went."""
        if name not in self._needed:
            return
        with self._changed:
            if alive:
                self._missing.discard(name)
                self._came = True
            else:
                self._missing.add(name)
            self._changed.notify_all()

    def wait_for_all(self, timeout_s: float) -> tuple[str, ...]:
        """Who is still missing after `timeout_s` at most; empty as soon as all are there."""
        with self._changed:
            self._changed.wait_for(lambda: not self._missing, timeout_s)
            return tuple(sorted(self._missing))

    def take_came(self) -> bool:
        """Whether one came since this was asked last: it has not heard what was sent before."""
        with self._changed:
            came, self._came = self._came, False
            return came
