# SPDX-License-Identifier: Apache-2.0
"""`kinemap train`: where its subcommands meet."""

import typer

from services.cli.train.scenes import scenes
from services.cli.train.segmenter import segmenter
from services.cli.train.vocabulary import vocabulary

train_app = typer.Typer(
    help="Make what the services load: the network that finds objects, the vocabulary that places are known by.",
    no_args_is_help=True,
)
train_app.command()(segmenter)
train_app.command()(scenes)
train_app.command()(vocabulary)
