# SPDX-License-Identifier: Apache-2.0
"""A tiny drive to write as a data set."""

from pathlib import Path

from services.simulator.data_sets.data_set import DataSet
from services.simulator.data_sets.request import FORMATS, DataSetRequest
from services.simulator.data_sets.workers import render_frames
from services.simulator.options import DriveOptions

TINY = DriveOptions(width=96, height=64, frames=4, rate_hz=2.0, empty_start_m=0.0, seed=3)
EVERYTHING = frozenset(FORMATS)


def tiny_request(**changes: object) -> DataSetRequest:
    """Everything there is of one sequence, unless `changes` say otherwise."""
    return DataSetRequest(**{"drive": TINY, "seeds": (3,), "formats": EVERYTHING, **changes})  # type: ignore[arg-type]


def make(root: Path, request: DataSetRequest, jobs: int = 1) -> list[tuple[str, int]]:
    """Make a data set, or go on with it; the frames that had to be rendered, in their order."""
    data_set = DataSet(root, request)
    with data_set.locked():
        left = data_set.frames_left()
        rendered = sorted((done.sequence, done.index) for done in render_frames(root, request, left, jobs))
        if not data_set.complete:
            data_set.finish()
    return rendered
