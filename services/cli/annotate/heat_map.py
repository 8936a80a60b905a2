# SPDX-License-Identifier: Apache-2.0
"""`kinemap dataset heatmap`: where moving objects lie in the image."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.progress import bar
from services.runtime.errors import InputError, ResourceError

_MOVING = "moving"


def heatmap(
    given: Annotated[
        list[Path],
        typer.Argument(
            metavar="FOLDER...",
            help="Folders of moving masks, in any kind that `kinemap evaluate moving` reads, or data sets of `kinemap "
            "simulate` or `kinemap dataset labelme`, whose moving/ are taken.",
        ),
    ],
    *,
    out: Annotated[Path, typer.Option("--out", "-o", metavar="PNG", help="The picture; its numbers go beside it.")],
) -> None:
    """Draw how often each pixel moves (figure 5.7 of the thesis), and say how much of that is at the centre."""
    from services.evaluation.moving_masks.inputs import MovingMaskFolder
    from services.evaluation.run.report import write_report
    from services.evaluation.thesis.heat_map import HeatMap, plot_heat_map

    if out.suffix.lower() != ".png":
        raise InputError(f"--out {out}: expected a name that ends in .png")
    folders = [MovingMaskFolder(folder) for path in given for folder in mask_folders(path)]
    heat = HeatMap()
    masks = [(folder, frame) for folder in folders for frame in folder.frames]
    for source, frame in bar(masks, "adding masks up"):
        heat.add(source.read(frame).mask)
    numbers = heat.describe()
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        plot_heat_map(heat, out, given[0].resolve().name if len(given) == 1 else "")
        write_report(
            {"folders": ["/".join(folder.path.resolve().parts[-2:]) for folder in folders], **numbers},
            out.with_suffix(".json"),
        )
    except OSError as error:
        raise ResourceError(f"--out {out}: cannot be written ({error.strerror})") from error
    print(f"frames            {heat.frames}, {heat.frames_with_movers} with something that moves")
    print(f"moving pixels     {numbers['moving_share_of_pixels']:.2%}")
    print(f"middle third      {heat.central_third:.1%} of the moving pixels (33.3 % if even)")
    print(f"middle ninth      {heat.central_ninth:.1%} (11.1 % if even)")
    print(f"entropy           {heat.entropy:.3f} (1 if even)")
    print(f"centre of mass    x {heat.mean_position[0]:.3f}, y {heat.mean_position[1]:.3f} of width and height")
    print(out)


def mask_folders(path: Path) -> list[Path]:
    """`path` itself, its moving/, or moving/ of each of its sequences. Raises InputError where there is no folder."""
    if not path.is_dir():
        raise InputError(f"{path}: no such folder, expected one of moving masks or a data set")
    if (path / _MOVING).is_dir():
        return [path / _MOVING]
    sequences = sorted(path.glob(f"sequences/*/{_MOVING}"))
    return sequences or [path]
