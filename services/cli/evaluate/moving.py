# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate moving`: masks of what moves against the truth."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.cli.evaluate.progress import bar


def moving(
    found: Annotated[
        Path,
        typer.Argument(
            metavar="MASKS",
            help="Folder of PNG masks: 0 background, 1 non-moving, 2 moving; or 0 and 255, moving; or label images "
            "whose instances.json says which instance moves.",
        ),
    ],
    *,
    truth: Annotated[Path, typer.Option(help="Folder of true masks, in any of the three kinds.")],
    min_height: Annotated[
        float, typer.Option(min=0.0, max=65535.0, help="Height, px, of the instances whose moving flag counts.")
    ] = 40.0,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """IoU of moving, non-moving and background and their mean; precision and recall of the flag of instances."""
    from services.evaluation.moving_masks.score import FlagRules, score_moving_masks
    from services.evaluation.moving_masks.table import describe_moving, moving_rows

    folder = check_outputs(json_file, plots, found, truth)
    rules = FlagRules(minimum_height_px=min_height)
    result = score_moving_masks(found, truth, rules, bar)
    print_table([found.resolve().name], moving_rows(result, rules))
    if result.missing:
        print(f"{len(result.missing)} true frames are not in {found}, {result.missing[0]} first: all background there")
    if result.without_truth:
        print(f"{result.without_truth} frames of {found} have no truth and do not count")
    keep_json({"found": str(found), "truth": str(truth), **describe_moving(result, rules)}, json_file)
    if folder is not None:
        from services.evaluation.moving_masks.plots import plot_confusion, plot_iou_over_frames

        plot_confusion(result, folder / "moving_confusion.png")
        plot_iou_over_frames(result, folder / "moving_iou.png")
