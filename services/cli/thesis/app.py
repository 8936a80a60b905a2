# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis`: where its subcommands meet."""

import typer

from services.cli.thesis.features import features
from services.cli.thesis.instances import instances
from services.cli.thesis.moseg import moseg
from services.cli.thesis.odometry import odometry

thesis_app = typer.Typer(
    help="Tables and figures of the thesis (Robust map building for robot navigation in dynamic environments, 2021), "
    "for who has the data.",
    no_args_is_help=True,
)
thesis_app.command()(odometry)
thesis_app.command()(instances)
thesis_app.command()(moseg)
thesis_app.command()(features)
