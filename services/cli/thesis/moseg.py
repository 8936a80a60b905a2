# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis moseg`: moving masks out of KITTI MoSeg's boxes, and predictions against them."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from services.cli.evaluate.progress import bar
from services.cli.thesis.output import Table, out_folder, print_markdown, write_results
from services.runtime.errors import InputError

NAME = "moseg"
MASKS = "moving"


def moseg(
    *,
    data: Annotated[
        Path,
        typer.Option(
            help="KITTI MoSeg, first release: {training,testing}/{images,mask,boxes}; masks are more than 0 where a "
            "car is, a line of boxes is 'id moving y1 x1 y2 x2'. Or a folder that holds mask and boxes itself."
        ),
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help=f"Folder for table and JSON, and {MASKS}/ for the masks.")],
    predictions: Annotated[
        Path | None,
        typer.Option(
            help="Folder of moving masks by the images' names, in any kind that `kinemap evaluate moving` reads."
        ),
    ] = None,
    split: Annotated[
        Literal["training", "testing"] | None, typer.Option(help="Which of the two (default: testing).")
    ] = None,
) -> None:
    """Turn boxes of moving cars and masks of all cars into moving masks, and score predicted ones against them.

    A car moves where the box that covers it best does; cars that touch in the mask are parted by their boxes. Written
    are 0 background, 1 a car that stands, 2 one that moves; scored is the IoU of each and their mean.
    """
    from services.evaluation.moving_masks.score import score_moving_masks
    from services.evaluation.thesis.moseg import derive_masks, describe_moseg, moseg_table
    from services.formats.kitti_moseg import moseg_frames

    frames = moseg_frames(data, split)
    if predictions is not None and not predictions.is_dir():
        raise InputError(f"--predictions {predictions}: no such folder, expected one of moving masks (PNG)")
    target = out_folder(out)
    masks = out_folder(target / MASKS)
    # Masks of another split would be scored as if they were of this one.
    for left in set(masks.glob("*.png")) - {masks / f"{frame.name}.png" for frame in frames}:
        raise InputError(f"{left}: not of this data set, expected --out that holds no other masks")
    derived = derive_masks(frames, masks, bar)
    share = "no car" if derived.moving_share is None else f"{derived.moving_share:.1%} of the cars' pixels move"
    parts: list[str | Table] = [
        f"{derived.frames} frames, {derived.moving_boxes} of {derived.boxes} boxes move, "
        f"{derived.frames_with_movers} frames with a car that moves; {share}."
    ]
    if derived.moving_px and not derived.non_moving_px:
        parts.append(
            "Every car in the masks moves: mask/ may hold moving cars alone, where those that stand belong too."
        )
    result = None
    if predictions is not None:
        result = score_moving_masks(predictions, masks, progress=bar)
        parts.append(moseg_table(result, predictions.resolve().name))
        if result.missing:
            parts.append(f"{len(result.missing)} frames have no prediction, {result.missing[0]} first: all background.")
        parts.append(
            "The thesis gives a mean IoU of 35 % and no more; its split and the classes of its mean are not said."
        )
    write_results(target, NAME, "Moving cars on KITTI MoSeg as in the thesis", parts, describe_moseg(derived, result))
    print_markdown(target, NAME)
