# SPDX-License-Identifier: Apache-2.0
"""`kinemap dataset flow-images`: the flow from each image to the next, as colours."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from services.cli.evaluate.progress import bar
from services.cli.thesis.output import out_folder
from services.runtime.errors import InputError

NAME = "flow-images"
RAW = "raw"
_SEQUENCE_IMAGES = ("image_2", "image_0")


def flow_images(
    given: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder of consecutive images, or a KITTI sequence's.")
    ],
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the flow images, named as the earlier image.")],
    preset: Annotated[Literal["ultrafast", "fast", "medium"], typer.Option(help="OpenCV's preset of DIS.")] = "medium",
    flow: Annotated[Literal["dis", "raft"], typer.Option(help="How it is computed.")] = "dis",
    weights: Annotated[
        str | None, typer.Option(help="raft: a .pth file or a name of `kinemap weights` (default: what was pulled).")
    ] = None,
    longest: Annotated[
        float | None,
        typer.Option(help="Flow in px that has the full colour (default: that which 1 % of an image's pixels exceed)."),
    ] = None,
    raw: Annotated[bool, typer.Option("--raw", help=f"Write KITTI's 16-bit PNG into {RAW}/ too.")] = False,
    frames: Annotated[int | None, typer.Option(min=2, help="Only the first so many images.")] = None,
) -> None:
    """Dense flow of consecutive images, coloured by Baker's wheel: direction is hue, length saturation."""
    import numpy as np

    from services.camera.sources.folders.image_files import ImageFiles
    from services.evaluation.pictures.flow_colours import flow_colours
    from services.evaluation.run.report import write_report
    from services.formats.kitti_flow import FlowImage, write_kitti_flow
    from services.formats.png import write_png
    from services.motion.flow.dense_flow import DenseFlow
    from services.motion.flow.options import OpticalFlowOptions

    if longest is not None and not 0.0 < longest < float("inf"):
        raise InputError(f"--longest {longest:g}: expected pixels, more than 0")
    images = ImageFiles(_image_folder(given))
    count = len(images) if frames is None else min(len(images), frames)
    if count < 2:
        raise InputError(f"{images.paths[0].parent}: {count} image, expected at least 2")
    target = out_folder(out)
    if target.resolve() == images.paths[0].parent.resolve():
        raise InputError(f"--out {out}: the folder of the images, expected another one")
    raw_folder = out_folder(target / RAW) if raw else None
    dense = DenseFlow(
        OpticalFlowOptions(preset, images.size[0], finest_level=0, algorithm=flow, weights=weights, device="auto")
    )
    described = {}

    later = images.read(0)
    for index in bar(range(count - 1), "flow"):
        earlier, later = later, images.read(index + 1)
        # Named for its use in the pipeline, where it looks back: here the earlier image is where it starts.
        found = dense.previous_from_current(earlier, later).flow
        length = np.hypot(found[..., 0], found[..., 1])
        shown = float(np.percentile(length, 99.0)) if longest is None else longest
        name = images.name(index)
        write_png(target / f"{name}.png", flow_colours(found, shown))
        if raw_folder is not None:
            write_kitti_flow(raw_folder / f"{name}.png", FlowImage(found, np.ones(found.shape[:2], dtype=np.bool_)))
        described[name] = {
            "next": images.name(index + 1),
            "full_colour_px": shown,
            "median_px": float(np.median(length)),
        }
    options = {"flow": flow, "weights": weights, "preset": preset, "longest_px": longest, "raw": raw}
    write_report(
        {"source": images.paths[0].parent.name, "options": options, "frames": described}, target / f"{NAME}.json"
    )
    print(f"{len(described)} flow images in {target}")


def _image_folder(given: Path) -> Path:
    if not given.is_dir():
        raise InputError(f"{given}: no such folder, expected one of consecutive images")
    return next((given / name for name in _SEQUENCE_IMAGES if (given / name).is_dir()), given)
