# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate tracking`: objects whose ids last against the truth."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.cli.evaluate.progress import bar


def tracking(
    found: Annotated[
        Path,
        typer.Argument(
            metavar="TRACKS",
            help="MOTS text, KITTI tracking labels or a folder of label images; or a folder of such sequences.",
        ),
    ],
    *,
    truth: Annotated[Path, typer.Option(help="The truth: boxes against boxes, masks against masks.")],
    category: Annotated[
        list[str] | None,
        typer.Option(help="Only this class; may be given again (default: car and pedestrian, as in KITTI)."),
    ] = None,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """HOTA, MOTA and IDF1 by trackeval, each class by itself, under KITTI's rules of what counts."""
    from services.evaluation.object_tracking.inputs import known_categories, read_sequence_pairs
    from services.evaluation.object_tracking.score import tracking_scores
    from services.evaluation.object_tracking.table import describe_tracking, tracking_rows

    folder = check_outputs(json_file, plots, found, truth)
    pairs = read_sequence_pairs(found, truth, bar)
    scores = tracking_scores(pairs, known_categories(pairs, category or []), bar)
    print_table(list(scores), tracking_rows(scores))
    keep_json({"found": str(found), "truth": str(truth), **describe_tracking(scores)}, json_file)
    if folder is not None:
        from services.evaluation.object_tracking.plots import plot_hota_by_iou, plot_sequences

        plot_hota_by_iou(scores, folder / "hota_by_iou.png")
        if len(pairs) > 1:
            plot_sequences(scores, folder / "hota_by_sequence.png")
