# SPDX-License-Identifier: Apache-2.0
"""`kinemap simulate`: data sets, and a picture of them, out of the simulator."""

import os
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.cli.flags import ConfigFlag, Overrides, SetFlag, parse_settings, resolve_config
from services.cli.simulate_progress import FrameProgress
from services.cli.simulate_seeds import parse_seeds, parse_size
from services.runtime.errors import InputError
from services.simulator.data_sets.request import DEFAULT_FORMATS, FORMATS, DataSetRequest, parse_formats
from services.simulator.options import DriveOptions

INTERRUPTED = 130
_SECTION = "simulator"
_SHEET_SEEDS = tuple(range(1, 13))


def simulate(
    *,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the data set; a begun one goes on.")
    ] = None,
    seeds: Annotated[str | None, typer.Option(help="One sequence a seed, such as 1,2,5-8.")] = None,
    seed: Annotated[int | None, typer.Option(help="The seed of a single sequence (default: simulator.seed).")] = None,
    world: Annotated[str | None, typer.Option(help="street, town or corridor.")] = None,
    frames: Annotated[int | None, typer.Option(help="Frames of each sequence.")] = None,
    size: Annotated[str | None, typer.Option(metavar="WIDTHxHEIGHT", help="Size of the images, px.")] = None,
    rate: Annotated[float | None, typer.Option(help="Frames a second.")] = None,
    formats: Annotated[
        str | None,
        typer.Option(
            metavar="NAME[,...]", help=f"What to write, of {', '.join(FORMATS)} (default: all but grey; kitti always)."
        ),
    ] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes that render (default: one a core).")] = None,
    sheet: Annotated[
        Path | None, typer.Option(metavar="FILE.jpg", help="Draw one frame a seed with all its truth instead.")
    ] = None,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Write drives through the simulator as a data set, with all that is true of them.

    The folder is in KITTI's odometry layout, with instances (COCO, MOTS, KITTI tracking, label images), flow, moving
    masks, depth and surfaces beside it; its README.txt says what is what. The same options give the same bytes. What
    was interrupted goes on with the same command; a folder that holds anything else is left alone.
    """
    if (out is None) == (sheet is None):
        raise InputError("expected either --out DIR for a data set or --sheet FILE.jpg for a picture")
    if seed is not None and seeds is not None:
        raise InputError(f"--seed {seed} and --seeds {seeds}: expected one of them")
    other = sorted(set(parse_settings(settings)) - {_SECTION})
    if other:
        raise InputError(f"--set {other[0]}...: expected {_SECTION}.FIELD=VALUE, the others are for kinemap run")
    width, height = parse_size(size) if size is not None else (None, None)
    given = {"seed": seed, "world": world, "frames": frames, "width": width, "height": height, "rate_hz": rate}
    flags: Overrides = {_SECTION: given}
    drive = DriveOptions(**resolve_config(config, settings, flags).simulator.model_dump())
    console = Console(stderr=True, markup=False)
    # Whoever ends this process politely means all that it started.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if sheet is not None:
        default = (drive.seed,) if seed is not None else _SHEET_SEEDS
        _draw_sheet(sheet, drive, parse_seeds(seeds) if seeds is not None else default, console)
    elif out is not None:
        chosen = parse_formats(formats.split(",")) if formats is not None else DEFAULT_FORMATS
        request = DataSetRequest(drive, parse_seeds(seeds) if seeds is not None else (drive.seed,), chosen)
        _make_data_set(out, request, jobs or os.cpu_count() or 1, console)


def _make_data_set(out: Path, request: DataSetRequest, jobs: int, console: Console) -> None:
    # The renderer costs a second to load: not before the options are known to be good.
    from services.simulator.data_sets.data_set import DataSet
    from services.simulator.data_sets.workers import render_frames

    data_set = DataSet(out, request)
    progress = FrameProgress(console, request.frame_count)
    with data_set.locked():
        try:
            left = data_set.frames_left()
            if data_set.complete:
                console.print("complete already: nothing to do", highlight=False)
            else:
                missing = sum(map(len, left.values()))
                progress.begin(request.frame_count - missing)
                with progress:
                    for done in render_frames(out, request, left, min(jobs, missing)):
                        progress.frame_done(done.sequence)
                data_set.finish()
                console.print(f"complete: {progress.summary()}", highlight=False, soft_wrap=True)
        except KeyboardInterrupt:
            print(
                f"interrupted: {progress.done} of {request.frame_count} frames are in {out}; "
                "the same command goes on with the others",
                file=sys.stderr,
            )
            raise typer.Exit(INTERRUPTED) from None
    print(out)


def _draw_sheet(path: Path, drive: DriveOptions, seeds: tuple[int, ...], console: Console) -> None:
    from services.cli.simulate_sheet import draw_sheet

    draw_sheet(path, drive, seeds, console)
    print(path)
