# SPDX-License-Identifier: Apache-2.0
"""`kinemap run`: one input through the whole pipeline, with one progress bar and a folder of results."""

import signal
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.camera.sources.live.live_address import is_live
from services.cli.flags import (
    ConfigFlag,
    InputArgument,
    OutFlag,
    Overrides,
    PortFlag,
    SetFlag,
    StageFlag,
    resolve_config,
)
from services.cli.map_files import require_map_files
from services.cli.pipeline_run import PipelineRun
from services.cli.ports import any_free_port, require_gateway_port
from services.cli.run_folder import new_run_folder, write_config
from services.cli.supervision import Supervision
from services.runtime.config import Config
from services.runtime.zenoh_bus import ZenohBus

_SIMULATOR = "simulator"


def run(
    given_input: InputArgument = None,
    *,
    stage: StageFlag = None,
    out: OutFlag = None,
    serve: Annotated[bool, typer.Option("--serve", help="Keep everything up afterwards, until Ctrl-C.")] = False,
    frames: Annotated[int | None, typer.Option("--frames", help="Stop after this many frames.")] = None,
    calibration: Annotated[Path | None, typer.Option(help="Calibration of images, a video, a bag or a camera.")] = None,
    instances: Annotated[Path | None, typer.Option(help="Folder of instance masks (default: INPUT/instances).")] = None,
    map_file: Annotated[
        Path | None, typer.Option("--map", metavar="FILE", help="Begin in the map of an earlier run (--save-map).")
    ] = None,
    localize_only: Annotated[
        bool, typer.Option("--localize-only", help="Only find the camera in --map, which stays as it is.")
    ] = False,
    save_map: Annotated[
        Path | None, typer.Option("--save-map", metavar="FILE", help="Write the whole map here at the end.")
    ] = None,
    port: PortFlag = None,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Drive INPUT through all services; exit code 0 only if all of it went through."""
    flags: Overrides = {
        "camera": {"input": given_input, "max_frames": frames, "calibration": calibration},
        "slam": {
            "stage": stage,
            "map_file": map_file,
            "localize_only": localize_only or None,
            "save_map": save_map,
        },
        "segmenter": {"instances": instances},
        "mapstore": {"http_port": port},
    }
    run_input(resolve_run(config, settings, flags, out), serve)


def resolve_run(file: Path | None, settings: list[str] | None, flags: Overrides, out: Path | None) -> Config:
    """The configuration of a new run: its folder and session named, its paths absolute, its bus on a port of its own.

    Raises InputError for what cannot be used; nothing has been written or started by then.
    """
    resolved = resolve_config(file, settings, flags)
    given_out = out if out is not None or "out" not in resolved.run.model_fields_set else resolved.run.out
    folder = new_run_folder(given_out)
    resolved.run.out = folder
    if "session" not in resolved.run.model_fields_set:
        resolved.run.session = folder.name
    if "entry_point" not in resolved.bus.model_fields_set and resolved.bus.router is None:
        resolved.bus.entry_point = f"tcp/127.0.0.1:{any_free_port()}"
    _make_absolute(resolved)
    _choose_delivery(resolved)
    return resolved


def open_briefly(config: Config) -> int:
    """Open the input as the camera will, so that what cannot be used ends here; its number of frames or -1."""
    from services.camera.configured_source import open_configured_source

    source = open_configured_source(config)
    try:
        return source.frame_count
    finally:
        source.close()


def run_input(config: Config, serve: bool) -> None:
    """Run `config.camera.input` through. Raises KinemapError when it did not go through whole."""
    frames = open_briefly(config)
    require_gateway_port(config)
    require_map_files(config)
    write_config(config)
    # Whoever ends this process politely means the whole run.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with ZenohBus(config.bus, lossless=False) as bus:
        services = Supervision(config.run.out, config, attached=True)
        PipelineRun(config, services, bus, Console(markup=False), frames).drive(serve)


def _make_absolute(config: Config) -> None:
    if config.camera.input != _SIMULATOR and not is_live(config.camera.input):
        config.camera.input = str(Path(config.camera.input).resolve())
    if config.camera.calibration is not None:
        config.camera.calibration = config.camera.calibration.resolve()
    if config.slam.map_file is not None:
        config.slam.map_file = config.slam.map_file.resolve()
    if config.slam.save_map is not None:
        config.slam.save_map = config.slam.save_map.resolve()
    if config.segmenter.instances is not None:
        config.segmenter.instances = config.segmenter.instances.resolve()


def _choose_delivery(config: Config) -> None:
    """A live camera is delivered in `realtime`, unless the user asked for something else: then the camera says no."""
    from services.camera.configured_delivery import require_realtime

    if is_live(config.camera.input) and "mode" not in config.delivery.model_fields_set:
        config.delivery.mode = "realtime"
    require_realtime(config)
