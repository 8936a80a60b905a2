# SPDX-License-Identifier: Apache-2.0
"""A service of a few lines, so that supervision can be tried without the weight of the real ones.

What it does is in the file `<run>/behaviour`: nothing (it lives), `bad input`, or `crash`.
"""

from services.runtime.config import Config
from services.runtime.errors import InputError
from services.runtime.host import ServiceHost, run_main
from services.runtime.zenoh_bus import ZenohBus


def serve(config: Config) -> None:
    """Live until SIGTERM."""
    behaviour = config.run.out / "behaviour"
    said = behaviour.read_text(encoding="utf-8") if behaviour.exists() else ""
    if said == "bad input":
        raise InputError("radius -1: expected a positive number")
    if said == "crash":
        raise RuntimeError("a fault nobody expected")
    with ZenohBus(config.bus, lossless=False) as bus, ServiceHost("small", bus, config.run.session) as host:
        host.ready()
        host.stopping.wait()
        (config.run.out / "drained").write_text("", encoding="utf-8")


if __name__ == "__main__":
    run_main("small", serve)
