# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate flow`: optical flow against the truth."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.cli.evaluate.progress import bar

_PICTURES = 4


def flow(
    found: Annotated[Path, typer.Argument(metavar="FLOW", help="KITTI flow (.png) or .flo: a file, or a folder.")],
    *,
    truth: Annotated[
        Path, typer.Option(help="The true flow: a file, a folder, or one that holds KITTI's flow_occ and flow_noc.")
    ],
    not_occluded: Annotated[
        Path | None, typer.Option(help="The true flow of the pixels that both images see, where it is apart.")
    ] = None,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """Endpoint error and KITTI's Fl, all and not occluded; pictures of the worst images."""
    from services.evaluation.optical_flow.inputs import find_flow_pairs
    from services.evaluation.optical_flow.score import flow_score
    from services.evaluation.optical_flow.table import COLUMNS, describe_flow, flow_rows

    folder = check_outputs(json_file, plots, found, truth, not_occluded)
    pairs = find_flow_pairs(found, truth, not_occluded)
    score = flow_score(pairs, bar)
    print_table(COLUMNS, flow_rows(score))
    if pairs.missing:
        print(f"{len(pairs.missing)} true images have no flow in {found} and do not count, {pairs.missing[0]} first")
    keep_json({"found": str(found), "truth": str(truth), "missing": pairs.missing, **describe_flow(score)}, json_file)
    if folder is not None:
        from services.evaluation.optical_flow.plots import plot_flow_errors, plot_flow_pair

        plot_flow_errors(score, folder / "flow_errors.png")
        worst = sorted(pairs.pairs, key=lambda pair: -(score.by_image[pair.name][1] or 0.0))[:_PICTURES]
        for pair in bar(worst, "drawing"):
            plot_flow_pair(pair, folder / f"flow_{pair.name}.png")
