# SPDX-License-Identifier: Apache-2.0
"""`kinemap export`: trajectories and point clouds out of a map."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.run_folder import CONFIG_NAME, newest_run_folder
from services.cli.run_results import DEFAULT_FORMATS, map_path
from services.runtime.config import load_config
from services.runtime.errors import InputError


def export(
    source: Annotated[
        Path | None, typer.Argument(metavar="[RUN]", help="Folder of a run or a map.sqlite (default: the newest run).")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder to write to (default: the map's).")] = None,
    formats: Annotated[
        list[str] | None, typer.Option("--format", "-f", help="tum, kitti, pcd; repeatable (default: tum and pcd).")
    ] = None,
) -> None:
    """Write trajectory.tum, keyframes.tum, map.pcd and the like from the map of a run."""
    from services.mapstore.export import export_map

    if source is not None and source.is_file():
        database = source
    else:
        folder = newest_run_folder(source)
        database = map_path(load_config(folder / CONFIG_NAME))
    if not database.is_file():
        raise InputError(f"{database}: no such file, expected the map of a run")
    target = out if out is not None else database.parent
    if target.exists() and not target.is_dir():
        raise InputError(f"--out {target}: is a file, expected a folder")
    target.mkdir(parents=True, exist_ok=True)
    for path in export_map(database, target, tuple(formats or DEFAULT_FORMATS)):
        print(path)
