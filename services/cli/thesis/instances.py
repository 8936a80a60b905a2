# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis instances`: figure 5.1 of the thesis, segmenters on KITTI's semantic-instance images."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.progress import bar
from services.cli.flags import ConfigFlag, SetFlag
from services.cli.thesis.output import Table, out_folder, print_markdown, write_results
from services.runtime.errors import InputError

NAME = "instances"
_NOTE = (
    "AP by pycocotools; a gain is in percent of the first segmenter's AP over IoU 0 to 1. Seconds are the segmenter's "
    "alone, one image at a time; label images were made before and have none. The thesis' times are of a laptop's "
    "Quadro P1000; the seconds an image are theirs by 200, where its text says 0.91 and 0.4."
)


def instances(
    *,
    data: Annotated[
        Path, typer.Option(help="KITTI's semantics data set: training/image_2 and training/instance (16-bit PNG).")
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for table, JSON and picture.")],
    predictions: Annotated[
        list[Path] | None,
        typer.Option(
            help="Label images and instances.json of one segmenter; repeat it to compare several, the first being the "
            "baseline (default: the configured segmenter, or DATA/instances)."
        ),
    ] = None,
    network: Annotated[
        list[str] | None,
        typer.Option(
            metavar="WEIGHTS",
            help="A model (.safetensors) or a name of `kinemap weights`; repeat it to compare several, the first being "
            "the baseline, such as --network mask-rcnn_r50 --network solov2_r50.",
        ),
    ] = None,
    category: Annotated[str, typer.Option(help="COCO's name of what is scored.")] = "car",
    min_score: Annotated[float, typer.Option(min=0.0, max=1.0, help="Instances of a lower score do not count.")] = 0.3,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Average precision of cars over IoU 0 to 1 as in the thesis, COCO's, and the seconds for all images."""
    from services.cli.thesis.instances_score import score_on_kitti
    from services.cli.thesis.segmenter_run import TimedSegmenter, open_segmenter
    from services.evaluation.instance_masks.plots import plot_precision_by_iou
    from services.evaluation.thesis.instances import describe_instances, instances_table, side_by_side
    from services.formats.kitti_semantic import CITYSCAPES_IDS, semantic_frames

    if category not in CITYSCAPES_IDS:
        raise InputError(f"--category {category}: expected one of {', '.join(CITYSCAPES_IDS)}")
    frames = semantic_frames(data)
    segmenters = {}
    given: list[tuple[str, Path | None, str | None]] = [
        (folder.resolve().name, folder, None) for folder in predictions or ()
    ]
    given += [(Path(weights).name, None, weights) for weights in network or ()]
    for name, folder, weights in given or [("configured", None, None)]:
        if name in segmenters:
            flag = "--network" if folder is None else "--predictions"
            raise InputError(f"{flag} {weights or folder}: one of that name was given already, expected another name")
        backend = open_segmenter(
            data, folder, category=category, min_score=min_score, weights=weights, config=config, settings=settings
        )
        segmenters[name] = TimedSegmenter(backend)
    target = out_folder(out)
    scores = []
    for name, segmenter in segmenters.items():
        scores.append(score_on_kitti(name, segmenter, frames, category, bar))
        segmenter.backend.close()
    plot_precision_by_iou(side_by_side(scores), target / f"{NAME}.png")
    parts: list[str | Table] = [instances_table(scores, category), _NOTE, f"![AP by IoU]({NAME}.png)"]
    title = f"Instances of {category} on KITTI as in the thesis"
    write_results(target, NAME, title, parts, describe_instances(scores, category, min_score))
    print_markdown(target, NAME)
