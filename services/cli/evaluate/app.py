# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate`: where its subcommands meet, and which of them a path without a subcommand means."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperGroup

from services.cli.evaluate.density import density
from services.cli.evaluate.flow import flow
from services.cli.evaluate.map import evaluate_map
from services.cli.evaluate.masks import masks
from services.cli.evaluate.moving import moving
from services.cli.evaluate.run import run
from services.cli.evaluate.tracking import tracking
from services.cli.evaluate.trajectory import trajectory


class EvaluateGroup(TyperGroup):
    """Takes `kinemap evaluate PATH...` as `run` for folders and as `trajectory` for files."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the subcommand that was meant in front of arguments that begin with none."""
        if args and args[0] not in self.commands and args[0] not in ctx.help_option_names:
            args = [subcommand_for(args), *args]
        return super().parse_args(ctx, args)


def subcommand_for(arguments: Sequence[str]) -> str:
    """`run` where the first argument that is no option is a folder, else `trajectory`."""
    first = next((argument for argument in arguments if not argument.startswith("-")), "")
    return "run" if first and Path(first).is_dir() else "trajectory"


evaluate_app = typer.Typer(
    cls=EvaluateGroup,
    help="Numbers of runs, and of files against the truth. A folder alone means `run`, a file alone `trajectory`.",
    no_args_is_help=True,
)
evaluate_app.command()(run)
evaluate_app.command()(trajectory)
evaluate_app.command()(density)
evaluate_app.command("map")(evaluate_map)
evaluate_app.command()(masks)
evaluate_app.command()(moving)
evaluate_app.command()(flow)
evaluate_app.command()(tracking)
