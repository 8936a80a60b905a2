# SPDX-License-Identifier: Apache-2.0
"""A zenoh router without zenohd, which neither Debian nor PyPI has: `python router.py router.json5`."""

import signal
import sys
import threading

import zenoh


def main() -> None:
    """Route until SIGTERM or SIGINT."""
    if len(sys.argv) != 2:
        sys.exit("router: expected one argument, the configuration file (router.json5)")
    stop = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    try:
        session = zenoh.open(zenoh.Config.from_file(sys.argv[1]))
    except zenoh.ZError as error:
        sys.exit(f"router: {error}")
    with session:
        stop.wait()


if __name__ == "__main__":
    main()
