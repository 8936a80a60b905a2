# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate density`: the density a run gave against what really moved around it."""

import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.cli.evaluate.session import RecoverFlag, session_of
from services.runtime.errors import InputError


def density(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run, or a recorded session (.mcap).")],
    *,
    min_height: Annotated[
        float, typer.Option(help="Height in the image, px, from which a truly moving object counts.")
    ] = 40.0,
    recover: RecoverFlag = False,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """Error of the density in moving objects, and in high and low; frames of unknown density stand apart."""
    from services.evaluation.density.error import density_error
    from services.evaluation.density.session import read_densities
    from services.evaluation.density.table import density_rows
    from services.evaluation.density.truth import TrueDensityRules
    from services.evaluation.run.comparison import ComparisonRow

    if not (math.isfinite(min_height) and min_height >= 0.0):
        raise InputError(f"--min-height {min_height:g}: expected pixels, 0 or more")
    folder = check_outputs(json_file, plots, run)
    session = session_of(run)
    densities = read_densities(session, TrueDensityRules(min_height), recover=recover)
    error = density_error(densities.frames)
    print_table([run.resolve().name], [ComparisonRow(what, (value,)) for what, value in density_rows(densities, error)])
    measured = {
        **asdict(error),
        "coverage": error.coverage,
        "precision": error.precision,
        "recall": error.recall,
        "radius": densities.radius,
        "metres_per_unit": densities.metres_per_unit,
        "window_s": densities.window_s,
        "rules": asdict(densities.rules),
    }
    keep_json({"session": str(session), **measured}, json_file)
    if folder is not None:
        from services.evaluation.density.plots import plot_density_error

        plot_density_error(densities, folder / "density.png")
