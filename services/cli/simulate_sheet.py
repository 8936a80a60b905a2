# SPDX-License-Identifier: Apache-2.0
"""The contact sheet of `kinemap simulate`: one frame of each seed."""

from dataclasses import replace
from pathlib import Path

from rich.console import Console

from services.cli.simulate_progress import FrameProgress
from services.evaluation.pictures.contact_sheet import SheetRow, draw_contact_sheet, write_sheet
from services.runtime.errors import InputError
from services.simulator.drive import Drive
from services.simulator.options import DriveOptions

SUFFIXES = (".jpg", ".jpeg")
_MAX_ROWS = 40
_FIRST, _LAST = 0.25, 0.95
"""Share of the drive between which the frames are taken: the street begins without traffic."""


def draw_sheet(path: Path, options: DriveOptions, seeds: tuple[int, ...], console: Console) -> None:
    """Draw a frame of each seed's drive, later and later ones, with depth, instances, moving flags and flow.

    Raises:
        InputError: no JPEG's name, more seeds than a sheet holds, a drive of one frame, which has no flow.
        ResourceError: the disk does not take it.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"--sheet {path}: expected a name that ends in {' or '.join(SUFFIXES)}")
    if not 0 < len(seeds) <= _MAX_ROWS:
        raise InputError(f"--sheet with {len(seeds)} seeds: expected 1 to {_MAX_ROWS}")
    if options.frames < 2:
        raise InputError(f"--sheet with frames={options.frames}: expected at least 2, for flow leads to the next one")
    progress = FrameProgress(console, len(seeds))
    progress.begin(0)
    rows = []
    with progress:
        for number, seed in enumerate(seeds):
            share = _FIRST + (_LAST - _FIRST) * (number + 0.5) / len(seeds)
            rows.append(_row(Drive(replace(options, seed=seed)), round(share * (options.frames - 2))))
            progress.frame_done(f"of seed {seed}")
    write_sheet(path, draw_contact_sheet(rows))


def _row(drive: Drive, index: int) -> SheetRow:
    frame, flow = drive.render(index), drive.flow(index)
    moving = frozenset(item.instance_id for item in frame.instances if item.moving)
    name = f"seed\n{drive.options.seed}\nframe\n{index}"
    return SheetRow(name, frame.image, frame.depth_m, frame.labels, moving, flow.flow_px, flow.visible)
