# SPDX-License-Identifier: Apache-2.0
"""`kinemap train`: where its subcommands meet."""

import typer

from services.cli.train.vocabulary import vocabulary

train_app = typer.Typer(
    help="Make what the services load: the vocabulary that places are known by.", no_args_is_help=True
)
train_app.command()(vocabulary)


@train_app.callback()
def _group() -> None:
    """Keep the subcommand's name, also where there is only one."""
