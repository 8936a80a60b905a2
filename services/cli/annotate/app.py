# SPDX-License-Identifier: Apache-2.0
"""`kinemap dataset`: where its subcommands meet."""

import typer

from services.cli.annotate.flow_images import flow_images
from services.cli.annotate.heat_map import heatmap
from services.cli.annotate.labelme import labelme

dataset_app = typer.Typer(
    help="Build a data set of moving objects of your own: masks from polygons, flow images, and where movers lie.",
    no_args_is_help=True,
)
dataset_app.command()(labelme)
dataset_app.command("flow-images")(flow_images)
dataset_app.command()(heatmap)
