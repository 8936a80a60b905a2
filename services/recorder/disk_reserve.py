# SPDX-License-Identifier: Apache-2.0
"""Disk space set aside, so that a session can still be closed when the disk is full."""

import os
from pathlib import Path


class DiskReserve:
    """A hidden file beside the session that holds `size` bytes of real disk until they are needed.

    Raises OSError (ENOSPC) when there are not even those.
    """

    def __init__(self, session: Path, size: int) -> None:
        self._path = session.with_name(f".{session.name}.reserve")
        descriptor = os.open(self._path, os.O_WRONLY | os.O_CREAT, 0o644)
        try:
            if size:
                os.posix_fallocate(descriptor, 0, size)
        except OSError:
            self.release()
            raise
        finally:
            os.close(descriptor)

    def release(self) -> None:
        """Give the space back to the disk; again does no harm."""
        self._path.unlink(missing_ok=True)
