# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate masks`: instance masks against the truth."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.cli.evaluate.progress import bar


def masks(
    found: Annotated[
        Path,
        typer.Argument(metavar="MASKS", help="COCO's results (.json), or a folder of label images (`instances/`)."),
    ],
    *,
    truth: Annotated[Path, typer.Option(help="COCO's annotations (.json), or a folder of label images.")],
    category: Annotated[
        list[str] | None, typer.Option(help="Only this category; may be given again (default: those of the truth).")
    ] = None,
    min_height: Annotated[
        float,
        typer.Option(min=0.0, max=65535.0, help="Height, px, of the instances that precision and recall are about."),
    ] = 40.0,
    min_score: Annotated[
        float, typer.Option(min=0.0, max=1.0, help="Score from which precision and recall count an instance.")
    ] = 0.3,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """Average precision by pycocotools, its mean over IoU 0 to 1 as in the thesis, and precision and recall."""
    from services.evaluation.instance_masks.average_precision import mask_precision
    from services.evaluation.instance_masks.confusion import class_confusion
    from services.evaluation.instance_masks.found import FoundRules, found_scores
    from services.evaluation.instance_masks.inputs import read_mask_input
    from services.evaluation.instance_masks.table import MEAN, describe_masks, mask_rows

    folder = check_outputs(json_file, plots, found, truth)
    rules = FoundRules(minimum_height_px=min_height, minimum_score=min_score)
    given = read_mask_input(found, truth, bar)
    ids = given.category_ids(category or [])
    score = mask_precision(given.truth, given.found, ids, bar)
    tall = found_scores(given.truth, given.found, ids, rules, bar)
    print_table([MEAN, *score.by_category], mask_rows(score, tall, rules))
    if given.without_result:
        first = given.without_result[0]
        print(
            f"{len(given.without_result)} of {score.images} true frames are not in {found}, {first} first: all missed"
        )
    if given.without_truth:
        print(f"{given.without_truth} frames of {found} have no truth and do not count")
    frames = {"without_result": given.without_result, "without_truth": given.without_truth}
    confusion = class_confusion(given.truth, given.found, rules, bar)
    measured = describe_masks(score, tall, confusion, rules)
    keep_json({"found": str(found), "truth": str(truth), "frames": frames, **measured}, json_file)
    if folder is not None:
        from services.evaluation.instance_masks.plots import (
            plot_class_confusion,
            plot_precision_by_iou,
            plot_precision_recall,
        )

        plot_precision_recall(tall, rules, folder / "precision_recall.png")
        plot_precision_by_iou(score, folder / "precision_by_iou.png")
        plot_class_confusion(confusion, folder / "class_confusion.png")
