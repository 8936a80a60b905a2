# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate`: where its subcommands meet, and which of them a path without a subcommand means."""

import errno
import io
import sys
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
from services.runtime.errors import ResourceError


class EvaluateGroup(TyperGroup):
    """Takes `kinemap evaluate PATH...` as `run` for folders and as `trajectory` for files."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the subcommand that was meant in front of arguments that begin with none."""
        if args and args[0] not in self.commands and args[0] not in ctx.help_option_names:
            args = [subcommand_for(args), *args]
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the subcommand; what it lacks on this machine is said in one line.

        Raises ResourceError for a package that is not installed, memory that is not to be had, and whatever else the
        system refuses.
        """
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # names of files need not be text
        try:
            return super().invoke(ctx)
        except ModuleNotFoundError as error:
            needed = "expected what evaluation needs: pip install 'kinemap[evaluation,tracking-evaluation]'"
            raise ResourceError(f"{error.name} is not installed, {needed}") from error
        except MemoryError as error:
            raise ResourceError(f"out of memory ({error}), expected less of input") from error
        except OSError as error:
            if error.errno == errno.EPIPE:
                raise  # whoever read the table has seen enough
            raise ResourceError(f"{error.filename or 'the system'}: {error.strerror or error}") from error


def subcommand_for(arguments: Sequence[str]) -> str:
    """`run` where the first argument that is no option is a folder, else `trajectory`."""
    first = next((argument for argument in arguments if not argument.startswith("-")), "")
    try:
        return "run" if first and Path(first).is_dir() else "trajectory"
    except OSError:
        return "trajectory"  # which says what is wrong with such a name


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
