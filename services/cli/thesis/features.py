# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis features`: parked objects, and what leaving their features out does to the rest (5.2.1.2)."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.flags import ConfigFlag
from services.cli.thesis.kitti_folders import parse_sequences, sequence_folders
from services.cli.thesis.output import Table, frame_bar, out_folder, print_markdown, write_results
from services.runtime.config import load_config
from services.runtime.errors import InputError

NAME = "features"
_NOTE = (
    "Skew is (right - left) / (right + left) of a frame's ORB features by image half: 0 is balanced, 1 is all on the "
    "right. Without moving objects means without those that move or are undecided, as stage `moving` tracks; without "
    "potentially dynamic ones is stage `dynamic`. A dash stands where nobody says which objects move. The thesis "
    "counts 95 % of the cars of KITTI 05 as parked."
)


def features(
    runs: Annotated[
        list[Path] | None, typer.Argument(metavar="[RUN...]", help="Folders of runs, whose tracker says what moves.")
    ] = None,
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for tables, JSON and the histogram.")],
    data: Annotated[
        Path | None,
        typer.Option(
            help="KITTI odometry, or what `kinemap simulate` writes: sequences/NN with images and instances/, whose "
            'instances.json says "moving" where it is known.'
        ),
    ] = None,
    sequences: Annotated[str, typer.Option(help="Sequences of --data.")] = "04,05,07",
    frames: Annotated[int | None, typer.Option(min=1, help="Only so many frames of each.")] = None,
    config: ConfigFlag = None,
) -> None:
    """The share of parked objects, and how features lie left and right with and without those on objects."""
    from services.cli.thesis.feature_frames import FrameSource, RecordedFrames, SequenceFrames, require_run
    from services.evaluation.thesis.feature_balance import FeatureBalance, SequenceBalance
    from services.evaluation.thesis.feature_table import describe_balance, objects_table, plot_skews, skew_table

    if not runs and data is None:
        raise InputError("expected folders of runs, or --data with sequences")
    for run in runs or ():
        require_run(run)
    folders = [] if data is None else sequence_folders(data, parse_sequences(sequences), with_poses=False)
    sources: list[FrameSource] = [
        *(RecordedFrames(run, frames) for run in runs or ()),
        *(SequenceFrames(folder, frames, config) for folder in folders),
    ]
    names = _own_names([source.folder for source in sources])
    target = out_folder(out)
    slam = load_config(config).slam
    counter = FeatureBalance(slam.features, slam.pyramid_levels, slam.pyramid_factor)
    measured = []
    for name, source in zip(names, sources, strict=True):
        balances = tuple(counter.measure(frame) for frame in frame_bar(source, source.frame_count, name))
        if not balances:
            raise InputError(f"{source.folder}: no frame with masks, expected at least one")
        measured.append(SequenceBalance(name, balances, source.without_masks))
    plot_skews(measured, target / f"{NAME}.png")
    parts: list[str | Table] = ["## Parked objects", objects_table(measured), "## Balance of features"]
    parts += [skew_table(measured), _NOTE, f"![Skew of every frame]({NAME}.png)"]
    write_results(target, NAME, "Objects and features as in the thesis", parts, describe_balance(measured))
    print_markdown(target, NAME)


def _own_names(folders: list[Path]) -> list[str]:
    """The folders' names, with as many parents as tell them apart."""
    paths = [folder.resolve() for folder in folders]
    if len(set(paths)) < len(paths):
        raise InputError(f"{max(paths, key=paths.count)}: given twice, expected each once")
    count = 1
    while len({path.parts[-count:] for path in paths}) < len(paths):
        count += 1
    return ["/".join(path.parts[-count:]) for path in paths]
