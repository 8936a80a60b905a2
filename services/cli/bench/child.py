# SPDX-License-Identifier: Apache-2.0
"""`python -m services.cli.bench.child PARENT_PID ARGUMENTS...`: the `kinemap` command, ended when its parent ends.

However the parent ends, be it by kill -9: a benchmark that was killed leaves no run behind.
"""

import ctypes
import os
import signal
import sys

from services.cli.app import main

_PR_SET_PDEATHSIG = 1


def run_child() -> None:
    """Run the command with what follows the parent's pid."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != int(sys.argv.pop(1)):
        return  # the parent was gone before the kernel could be asked to tell
    main()


if __name__ == "__main__":
    run_child()
