# SPDX-License-Identifier: Apache-2.0
"""The error of a run's density as text."""

import math

from services.evaluation.density.error import DensityError
from services.evaluation.density.session import SessionDensities


def density_rows(densities: SessionDensities, error: DensityError) -> list[tuple[str, str]]:
    """(what, value) pairs, in the order to show them."""
    covered = f"({error.coverage:.1%})"
    window = "ever" if math.isinf(densities.window_s) else f"in the last {densities.window_s:g} s"
    scale = "" if densities.metres_per_unit == 1.0 else f" ({densities.radius:g} map units, scale arbitrary)"
    return [
        ("counted", f"within {densities.radius * densities.metres_per_unit:.3g} m{scale}, {window}"),
        ("truth", f"moving objects of at least {densities.rules.minimum_height_px:g} px in height"),
        ("frames", f"{error.compared} of {error.frames} {covered}, the others of unknown density"),
        ("mean absolute error [objects]", f"{_number(error.mean_absolute_objects)} {covered}"),
        ("bias [objects]", f"{_number(error.bias_objects, sign=True)} {covered}"),
        ("truly high, said high / low", f"{error.true_positives} / {error.false_negatives}"),
        ("truly low, said high / low", f"{error.false_positives} / {error.true_negatives}"),
        ("unknown, truly high / low", f"{error.unknown_truly_high} / {error.unknown_truly_low}"),
        ("precision of high", f"{_number(error.precision)} {covered}"),
        ("recall of high", f"{_number(error.recall)} {covered}"),
    ]


def _number(value: float | None, *, sign: bool = False) -> str:
    if value is None:
        return "undefined"
    return f"{value:+.3f}" if sign else f"{value:.3f}"
