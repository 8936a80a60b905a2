# SPDX-License-Identifier: Apache-2.0
"""`kinemap train vocabulary`: the words that places are known by, learned from simulated images."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from services.cli.evaluate.progress import bar
from services.cli.train.simulated_views import SimulatedViews
from services.runtime.errors import InputError, ResourceError
from services.slam.vocabulary import SHIPPED_VOCABULARY

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


def vocabulary(
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="The file to write.")] = SHIPPED_VOCABULARY,
    drives: Annotated[int, typer.Option(min=1, help="Simulated drives: a seed each, worlds and lights in turn.")] = 20,
    views: Annotated[int, typer.Option(min=1, help="Images of each drive, evenly along it.")] = 16,
    first_seed: Annotated[int, typer.Option(min=0, help="The first drive's seed; the others count up.")] = 1001,
    images: Annotated[
        list[Path] | None, typer.Option(metavar="FOLDER", help="Learn from these images instead; may be repeated.")
    ] = None,
    every: Annotated[int, typer.Option(min=1, help="With --images: only every so manieth.")] = 1,
    branching: Annotated[int, typer.Option(help="Children a node of the tree.")] = 8,
    depth: Annotated[int, typer.Option(help="Levels of the tree.")] = 5,
    features: Annotated[int, typer.Option(help="Features an image.")] = 2000,
    seed: Annotated[int, typer.Option(min=0, help="Of the clustering's first centres.")] = 0,
) -> None:
    """Learn a vocabulary of binary words for recognising places, and write it.

    Without --images it renders its own, which takes minutes. The same options and the same features of the engine give
    the same bytes; it must be trained again whenever the engine's descriptors change. Without --out it replaces the
    file that is shipped.
    """
    from services.slam.vocabulary.training import train_vocabulary

    if not out.parent.is_dir():
        raise InputError(f"--out {out}: expected a file in a folder that is there")
    source: Iterable[npt.NDArray[np.uint8]]
    if images:
        source = _read(images, every)
    else:
        rendered = SimulatedViews(first_seed, drives, views)
        source = (image for image, _ in zip(rendered, bar(range(len(rendered)), "images"), strict=False))
    trained = train_vocabulary(source, branching=branching, depth=depth, features=features, seed=seed)
    try:
        trained.save(str(out))
    except RuntimeError as error:
        raise ResourceError(str(error)) from error
    print(f"{out}: {trained.word_count} words, {out.stat().st_size / 1e6:.2f} MB")


def _read(folders: list[Path], every: int) -> "Iterator[npt.NDArray[np.uint8]]":
    import cv2
    import numpy as np

    from services.camera.sources.folders.image_files import ImageFiles

    for folder in folders:
        files = ImageFiles(folder)
        for index in bar(range(0, len(files), every), folder.name):
            pixels = files.read(index)
            yield pixels if pixels.ndim == 2 else np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY), np.uint8)
