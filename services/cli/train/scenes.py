# SPDX-License-Identifier: Apache-2.0
"""`kinemap train scenes`: simulated images for the segmenter to learn from, as unlike one another as can be."""

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

from services.cli.simulate_progress import FrameProgress
from services.runtime.errors import InputError
from services.simulator.data_sets.request import DataSetRequest
from services.simulator.options import DriveOptions, Light, WorldName

_WORLDS: tuple[WorldName, ...] = ("town", "street", "town", "corridor")
_LIGHTS: tuple[Light, ...] = ("noon", "low_sun", "overcast", "dusk")
_SIZES = ((1242, 375), (960, 540), (640, 480), (852, 448))
_FIELDS_OF_VIEW_DEG = (50.0, 100.0)
_FORMATS = frozenset({"kitti", "coco"})
_SLOW_HZ = {"town": 1.0, "street": 2.0, "corridor": 1.0}
"""Frames a second: a view should not be like the one before."""


def scene_requests(drives: int, views: int, first_seed: int) -> Iterator[tuple[str, DataSetRequest]]:
    """Name and request of each drive: world, light, camera, weather of the sensor and traffic drawn from its seed."""
    for number in range(drives):
        seed = first_seed + number
        random = np.random.default_rng((seed, 77))
        world = _WORLDS[number % len(_WORLDS)]
        width, height = _SIZES[int(random.integers(len(_SIZES)))]
        half_angle = np.radians(random.uniform(*_FIELDS_OF_VIEW_DEG)) / 2
        drive = DriveOptions(
            world=world,
            seed=seed,
            frames=views,
            rate_hz=_SLOW_HZ[world],
            width=width,
            height=height,
            fx_px=float(width / 2 / np.tan(half_angle)),
            camera_height_m=float(random.uniform(0.5, 2.2)),
            light=_LIGHTS[int(random.integers(len(_LIGHTS)))],
            shadows=bool(random.random() < 0.5),
            exposure_wobble=float(random.uniform(0, 0.5)),
            noise=float(random.uniform(0, 4)),
            motion_blur=float(random.choice([0.0, 0.3])),
        )
        if world in ("town", "corridor"):
            drive = replace(drive, traffic=float(random.uniform(0.3, 1.0)))
        yield f"{number:04d}", DataSetRequest(drive, (seed,), _FORMATS)


def scenes(
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the data sets; a begun one goes on.")],
    drives: Annotated[int, typer.Option(min=1, max=9999, help="Drives, each through a world of its own.")] = 200,
    views: Annotated[int, typer.Option(min=1, help="Images of each drive.")] = 40,
    first_seed: Annotated[int, typer.Option(min=0, help="The first drive's seed; the others count up.")] = 10_000,
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes that render (default: one a core).")] = None,
) -> None:
    """Render drives for `kinemap train segmenter`: OUT/0000, OUT/0001..., each as `kinemap simulate` writes it.

    Same options, same bytes. Interrupted, the same command goes on.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out}: is a file, expected a folder")
    from services.simulator.data_sets.data_set import DataSet
    from services.simulator.data_sets.workers import render_frames

    progress = FrameProgress(Console(stderr=True, markup=False), drives * views)
    progress.begin(0)
    with progress:
        for name, request in scene_requests(drives, views, first_seed):
            data_set = DataSet(out / name, request)
            with data_set.locked():
                left = data_set.frames_left()
                missing = sum(map(len, left.values()))
                for _ in range(request.frame_count - missing):
                    progress.frame_done(name)
                if data_set.complete:
                    continue
                for _ in render_frames(out / name, request, left, min(jobs or os.cpu_count() or 1, max(missing, 1))):
                    progress.frame_done(name)
                data_set.finish()
    print(out)
