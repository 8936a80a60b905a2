# SPDX-License-Identifier: Apache-2.0
"""The contact sheet of `kinemap simulate`: one frame of each seed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from services.cli.simulate_progress import FrameProgress
from services.evaluation.pictures.contact_sheet import SheetRow, draw_contact_sheet, write_sheet
from services.runtime.errors import InputError
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame
from services.simulator.options import DriveOptions

SUFFIXES = (".jpg", ".jpeg")
_MAX_ROWS = 40
_FIRST, _LAST = 0.25, 0.95
"""Share of the drive between which the frames are taken: the street begins without traffic."""
_SPREAD = 0.02
"""Share of the drive between the frames of which one is chosen."""
_BIG = 0.0005
"""Share of the image from which an instance counts."""
_STEP_M = 0.1


def draw_sheet(path: Path, options: DriveOptions, seeds: tuple[int, ...], console: Console) -> None:
    """Draw a frame of each seed's drive, later and later ones, with depth, instances, moving flags and flow.

    Of five frames near its place in the drive, the one that shows most is taken.

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
    """The frame that shows most near `index`."""
    last = drive.frame_count - 2
    spread = max(1, round(_SPREAD * last))
    near = sorted({min(max(index + offset * spread, 0), last) for offset in range(-2, 3)})
    frame = max((drive.render(number) for number in near), key=lambda frame: _shown(drive, frame))
    flow = drive.flow(frame.index)
    moving = frozenset(item.instance_id for item in frame.instances if item.moving)
    name = f"seed\n{drive.options.seed}\nframe\n{frame.index}"
    return SheetRow(name, frame.image, frame.depth_m, frame.labels, moving, flow.flow_px, flow.visible)


def _shown(drive: Drive, frame: SimulatedFrame) -> tuple[bool, int, int]:
    """How much a frame shows: the camera moving, kinds of things that move or stand, how many; not the far ones."""
    way = drive.world_from_camera(frame.index + 1)[:3, 3] - frame.world_from_camera[:3, 3]
    big = [item for item in frame.instances if item.visible_px >= _BIG * frame.labels.size]
    return float(np.linalg.norm(way)) > _STEP_M, len({(item.category, item.moving) for item in big}), len(big)
