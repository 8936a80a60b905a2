# SPDX-License-Identifier: Apache-2.0
"""The `kinemap` command: where its commands meet, and where every KinemapError ends in one line."""

import sys

import typer

from services.cli.annotate.app import dataset_app
from services.cli.bench.command import bench
from services.cli.config import config_app
from services.cli.doctor import doctor
from services.cli.down import down
from services.cli.evaluate.app import evaluate_app
from services.cli.export import export
from services.cli.record import record
from services.cli.replay import replay
from services.cli.run import run
from services.cli.simulate import simulate
from services.cli.status import status
from services.cli.thesis.app import thesis_app
from services.cli.train.app import train_app
from services.cli.up import up
from services.cli.weights.app import weights_app
from services.runtime.errors import KinemapError

INTERRUPTED = 130

app = typer.Typer(
    name="kinemap",
    help="Drives a camera, or a recording of one, through a mapping of places where things move.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (run, up, down, status, record, replay, export, bench, simulate):
    app.command()(command)
app.add_typer(config_app, name="config")
app.add_typer(evaluate_app, name="evaluate")
app.add_typer(thesis_app, name="thesis")
app.add_typer(dataset_app, name="dataset")
app.add_typer(train_app, name="train")
app.add_typer(weights_app, name="weights")
app.command()(doctor)


def main() -> None:
    """Run the command line; exit code 2 for input that cannot be used, 1 for what else went wrong."""
    try:
        app(prog_name="kinemap")
    except KinemapError as error:
        # One line, whatever a file's name holds.
        print(f"kinemap: error: {' '.join(str(error).splitlines())}", file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
