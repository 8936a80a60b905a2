# SPDX-License-Identifier: Apache-2.0
"""The one known address of the bus: `python -m services.runtime.entry_point --config FILE`.

It carries no messages of its own; services that start ask it who else is there. Killed, it is missed only by
services that start while it is away.
"""

from services.runtime.config import Config
from services.runtime.host import ServiceHost, run_main
from services.runtime.zenoh_bus import open_session


def serve(config: Config) -> None:
    """Listen at the configured address until SIGTERM; with a router there is nothing to listen for."""
    if config.bus.router is not None:
        ServiceHost.catch_signals().wait()
        return
    with open_session(config.bus, listen=config.bus.entry_point, connect=False):
        stop = ServiceHost.catch_signals()
        stop.wait()


if __name__ == "__main__":
    run_main("bus", serve)
