# SPDX-License-Identifier: Apache-2.0
"""`kinemap weights list|pull|import`."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, DownloadColumn, Progress, TimeRemainingColumn, TransferSpeedColumn
from rich.table import Table

weights_app = typer.Typer(
    help="Get the networks that find objects and flow, and see which are here.", no_args_is_help=True
)


@weights_app.command("list")
def list_models() -> None:
    """List the public models that can be pulled, and what the cache holds."""
    from services.motion.flow.public_weights import PUBLIC_WEIGHTS
    from services.segmenter.weights.catalogue import PUBLIC_MODELS
    from services.segmenter.weights.model_file import read_description
    from services.segmenter.weights.store import cached_models
    from services.weights.cache_folder import cache_folder

    here = {path.stem: path for path in cached_models()}
    table = Table(box=None, pad_edge=False)
    for column in ("name", "mask AP", "in the cache", "from"):
        table.add_column(column, no_wrap=True)
    for model in PUBLIC_MODELS:
        path = here.pop(model.name, None)
        table.add_row(model.name, f"{model.mask_ap:.1f} %", _size(path), "mmdetection, COCO")
    for weights in PUBLIC_WEIGHTS:
        table.add_row(weights.name, "", _size(weights.here()), f"torchvision, {weights.trained_on}")
    for name, path in here.items():
        table.add_row(name, "", _size(path), read_description(path).source)
    console = Console()
    console.print(table, soft_wrap=True)
    console.print(f"cache: {cache_folder()}", soft_wrap=True)


def _size(path: Path | None) -> str:
    return "" if path is None else f"{path.stat().st_size / 1e6:.0f} MB"


@weights_app.command()
def pull(
    name: Annotated[str, typer.Argument(help="A name of `kinemap weights list`; a variant takes the best of it.")],
) -> None:
    """Download a public model, check it and keep it in the cache. Goes on where it was cut off."""
    from services.motion.flow.public_weights import PUBLIC_WEIGHTS
    from services.segmenter.weights.catalogue import public_model
    from services.segmenter.weights.store import pull as pull_model

    flow = next((weights for weights in PUBLIC_WEIGHTS if name in (weights.name, weights.file_name)), None)
    fetch = flow.pull if flow is not None else partial(pull_model, public_model(name))
    columns = (BarColumn(), DownloadColumn(), TransferSpeedColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(name, total=None)
        path = fetch(lambda done, total: bar.update(task, completed=done, total=total))
    print(path)


@weights_app.command("import")
def import_model(
    file: Annotated[Path, typer.Argument(help="A .pth of mmdetection or torchvision's RAFT, or a .safetensors.")],
) -> None:
    """Take a file that was got elsewhere into the cache, checked and converted. The file stays as it is."""
    from services.motion.flow.public_weights import PUBLIC_WEIGHTS
    from services.segmenter.weights.store import import_file

    flow = next((weights for weights in PUBLIC_WEIGHTS if weights.file_name == file.name), None)
    print(import_file(file) if flow is None else flow.take(file))
