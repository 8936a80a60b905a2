# SPDX-License-Identifier: Apache-2.0
"""supervisord as a child of kinemap: `python -m services.cli.supervisord_process CONF [PARENT_PID]`.

With PARENT_PID it ends, and all services with it, when that process does, be it by kill -9.
"""

import ctypes
import os
import signal
import sys

from supervisor import supervisord

_PR_SET_PDEATHSIG = 1


def main() -> None:
    """Run supervisord until it is told to end."""
    if len(sys.argv) > 2:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != int(sys.argv[2]):
            return  # the parent was gone before the kernel could be asked to tell
    supervisord.main(["-c", sys.argv[1]])


if __name__ == "__main__":
    main()
