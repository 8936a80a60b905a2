# SPDX-License-Identifier: Apache-2.0
"""`kinemap up`: the services in the background, until `kinemap down`."""

from rich.console import Console

from services.cli.flags import ConfigFlag, InputArgument, OutFlag, Overrides, PortFlag, SetFlag, StageFlag
from services.cli.ports import gateway_url, require_gateway_port
from services.cli.run import open_briefly, resolve_run
from services.cli.run_folder import write_config
from services.cli.supervision import Supervision


def up(
    given_input: InputArgument = None,
    *,
    stage: StageFlag = None,
    out: OutFlag = None,
    port: PortFlag = None,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Start all services on INPUT and return when they live; they go on in the background, until `kinemap down`."""
    flags: Overrides = {"camera": {"input": given_input}, "slam": {"stage": stage}, "mapstore": {"http_port": port}}
    resolved = resolve_run(config, settings, flags, out)
    open_briefly(resolved)
    require_gateway_port(resolved)
    write_config(resolved)
    Supervision(resolved.run.out, resolved).up()
    console = Console(markup=False)
    where = f"{resolved.run.out}, {gateway_url(resolved)}, bus {resolved.bus.entry_point}"
    console.print(f"up: {where}", highlight=False, soft_wrap=True)
