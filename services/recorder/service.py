# SPDX-License-Identifier: Apache-2.0
"""The recorder's process: `python -m services.recorder.service --config FILE`."""

import json

from schemas.topics import ANSWERING_SERVICES
from services.recorder.frame_ledger import FrameLedger
from services.recorder.recorder import NAME, Recorder
from services.recorder.session_writer import SessionWriter, WriterOptions
from services.runtime.bus import Bus
from services.runtime.config import Config, dump_config
from services.runtime.host import ServiceHost, run_main
from services.runtime.zenoh_bus import ZenohBus


def open_recorder(config: Config, bus: Bus) -> Recorder:
    """The recorder of `config.run`'s session. Raises InputError or ResourceError when its file cannot be had."""
    lossless = config.delivery.mode == "lossless"
    writer = SessionWriter(
        config.run.out / config.recorder.file,
        config.run.session,
        json.dumps(dump_config(config), sort_keys=True),
        WriterOptions(config.recorder.zstd_level, config.recorder.reserve_mb << 20),
    )
    ledger = FrameLedger(
        config.recorder.producers,
        [service for service in ANSWERING_SERVICES if service != NAME],
        lossless=lossless,
        capacity=max(config.delivery.pending_bundles, 4 * config.delivery.window),
        recorded=writer.recovered,
    )
    return Recorder(writer, ledger, bus, config.run.session)


def serve(config: Config) -> None:
    """Record until SIGTERM."""
    with ZenohBus(config.bus, lossless=config.delivery.mode == "lossless") as bus:
        recorder = open_recorder(config, bus)
        try:
            with ServiceHost(NAME, bus, config.run.session) as host:
                host.metrics = recorder.metrics
                host.drive(recorder)
        finally:
            recorder.close()


if __name__ == "__main__":
    run_main(NAME, serve)
