# SPDX-License-Identifier: Apache-2.0
"""supervisord, spoken to over the unix socket of a run."""

import hashlib
import tempfile
import xmlrpc.client
from dataclasses import dataclass
from http.client import HTTPException
from pathlib import Path
from typing import Any

from supervisor.xmlrpc import SupervisorTransport

_LONGEST_SOCKET_PATH = 100
"""bytes; sun_path holds 108, and supervisord first makes the socket under a name with its pid behind"""


@dataclass(frozen=True)
class ProcessInfo:
    """One process as supervisord sees it."""

    name: str
    state: str
    """starting, running, backoff, stopping, stopped, exited or fatal"""
    pid: int
    """0: none"""
    exit_code: int
    """of its last end; -1 where a signal ended it"""
    uptime_s: int

    @property
    def ended_well(self) -> bool:
        """It has done what it had to do."""
        return self.state == "exited" and self.exit_code == 0


class SupervisordClient:
    """Answers None, or False, where supervisord does not answer: that is a state of a run, no error."""

    def __init__(self, socket: Path) -> None:
        self._socket = socket

    def processes(self) -> list[ProcessInfo] | None:
        """All processes, in the order they are spawned."""
        rows = self._call("supervisor.getAllProcessInfo")
        if rows is None:
            return None
        return [
            ProcessInfo(
                name=row["name"],
                state=row["statename"].lower(),
                pid=row["pid"],
                exit_code=row["exitstatus"],
                uptime_s=row["now"] - row["start"] if row["pid"] else 0,
            )
            for row in rows
        ]

    def pid(self) -> int | None:
        """supervisord's own process."""
        pid: int | None = self._call("supervisor.getPID")
        return pid

    def stop_all(self) -> bool:
        """Send every process its SIGTERM, all at once, then have supervisord wait for them and end itself."""
        signalled = self._call("supervisor.stopAllProcesses", False) is not None
        return self._call("supervisor.shutdown") is not None and signalled

    def _call(self, method: str, *arguments: Any) -> Any:
        transport = SupervisorTransport(None, None, f"unix://{self._socket}")
        try:
            with xmlrpc.client.ServerProxy("http://127.0.0.1", transport=transport) as proxy:
                return getattr(proxy, method)(*arguments)
        except (OSError, HTTPException, xmlrpc.client.Error):
            return None


def socket_of(folder: Path) -> Path:
    """The socket of a run: in its folder, or where that path is too long for a socket, in a folder under /tmp.

    The same for the same folder, so that whoever knows the run finds it.
    """
    socket = folder / "supervisor.sock"
    if len(str(socket).encode()) <= _LONGEST_SOCKET_PATH:
        return socket
    digest = hashlib.sha256(str(folder).encode()).hexdigest()[:16]
    return Path(tempfile.gettempdir()) / f"kinemap-{digest}" / "supervisor.sock"
