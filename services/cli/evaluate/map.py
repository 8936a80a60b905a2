# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate map`: a map against the true surface, in distance and in labels."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.cli.evaluate.session import RecoverFlag, session_of
from services.evaluation.trajectory.alignment import Alignment
from services.formats.point_cloud import LabelledPoints
from services.runtime.errors import InputError

if TYPE_CHECKING:  # matplotlib and scipy are loaded by who needs them
    from services.evaluation.map.alignment import MapAlignment
    from services.evaluation.map.surface import SurfaceOptions

MAP_NAME = "map.pcd"
NOT_ALIGNED = "none: the map is taken to be in the surface's frame"


def evaluate_map(
    source: Annotated[Path, typer.Argument(metavar="MAP", help="Folder of a run, or a map as points (.pcd, .ply).")],
    *,
    surface: Annotated[
        Path | None,
        typer.Option(help="True surface, points with state (.ply, .pcd); a run's folder has it in its true depth."),
    ] = None,
    trajectory: Annotated[
        Path | None, typer.Option(help="Camera path in the map, to align it by; a run's folder holds its own.")
    ] = None,
    truth: Annotated[
        Path | None, typer.Option(help="True camera path in the surface's frame; a run's folder holds its own.")
    ] = None,
    times: Annotated[Path | None, typer.Option(help="Times of trajectories in KITTI format.")] = None,
    align: Annotated[
        Alignment,
        typer.Option(
            help="What may be fitted: nothing (none), rotation and translation (se3), or the scale too (sim3)."
        ),
    ] = Alignment.SIM3,
    within: Annotated[float, typer.Option(help="Metres from the true path up to which is compared.")] = 40.0,
    near: Annotated[float, typer.Option(help="Metres up to which a point counts as met.")] = 0.2,
    label_within: Annotated[
        float, typer.Option(help="Metres up to which a landmark takes the label of the surface.")
    ] = 0.5,
    every: Annotated[int, typer.Option(min=1, help="Of a run: take what stands from every so many frames.")] = 5,
    voxel: Annotated[float, typer.Option(help="Of a run: one surface point for every cube of so many metres.")] = 0.1,
    recover: RecoverFlag = False,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """Chamfer distance of a map to the true surface, and how many landmarks are called what they are."""
    from services.evaluation.map.error import MapErrorRules, map_error
    from services.evaluation.map.surface import SurfaceOptions
    from services.evaluation.map.table import describe_map_error, map_rows
    from services.evaluation.run.comparison import ComparisonRow
    from services.formats.point_cloud import read_points

    rules = MapErrorRules(within, near, label_within)
    options = SurfaceOptions(every, voxel, within)
    if not source.is_dir() and surface is None:
        raise InputError(f"{source}: expected --surface with the true surface, or the folder of a run instead")
    folder = check_outputs(json_file, plots, source, surface, trajectory, truth)
    landmarks = read_points(source / MAP_NAME if source.is_dir() else source)
    alignment = _alignment(source, trajectory, truth, times, align)
    if alignment is not None:
        landmarks = alignment.points(landmarks)
    true_surface = _recorded_surface(source, options, recover) if surface is None else read_points(surface)
    error = map_error(landmarks, true_surface, None if alignment is None else alignment.path_m, rules)
    rows = [("alignment", NOT_ALIGNED if alignment is None else alignment.described()), *map_rows(error, rules)]
    print_table([source.resolve().name], [ComparisonRow(what, (value,)) for what, value in rows])
    keep_json({"map": str(source), "alignment": rows[0][1], **describe_map_error(error, rules)}, json_file)
    if folder is not None:
        from services.evaluation.map.plots import plot_label_confusion, plot_map_error
        from services.evaluation.trajectory.ground_plane import FLAT, ground_plane

        plane = FLAT if alignment is None else ground_plane(alignment.truth.world_from_camera)
        plot_map_error(landmarks, true_surface, error, plane, folder / "map_error.png")
        plot_label_confusion(error, folder / "map_labels.png")


def _alignment(
    source: Path, trajectory: Path | None, truth: Path | None, times: Path | None, align: Alignment
) -> "MapAlignment | None":
    from services.evaluation.map.alignment import map_alignment
    from services.evaluation.run.folder import TRAJECTORY_NAME, TRUTH_NAME
    from services.evaluation.trajectory.files import read_trajectory

    if source.is_dir():
        trajectory, truth = trajectory or source / TRAJECTORY_NAME, truth or source / TRUTH_NAME
    if trajectory is None and truth is None:
        return None
    if trajectory is None or truth is None:
        raise InputError("--trajectory and --truth align a map together, expected both or neither")
    return map_alignment(read_trajectory(trajectory, times=times), read_trajectory(truth, times=times), align)


def _recorded_surface(run: Path, options: "SurfaceOptions", recover: bool) -> LabelledPoints:
    from services.evaluation.map.session_surface import session_surface

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("true surface", total=None)
        return session_surface(
            session_of(run),
            options,
            recover=recover,
            on_frame=lambda done, total: progress.update(task, completed=done, total=total),
        )
