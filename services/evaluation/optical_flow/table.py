# SPDX-License-Identifier: Apache-2.0
"""The score of flow as text and as JSON."""

from services.evaluation.optical_flow.error import BANDS_PX, FlowError
from services.evaluation.optical_flow.score import FlowScore
from services.evaluation.run.comparison import NOTHING, ComparisonRow
from services.evaluation.run.outcome import Report

COLUMNS = ("all pixels", "not occluded")


def flow_rows(score: FlowScore) -> list[ComparisonRow]:
    """One row a measure; a dash where nobody said which pixels are occluded."""
    sides = (score.all, score.visible)
    rows = [
        ComparisonRow(
            "images", (str(len(score.by_image)), str(len(score.by_image)) if sides[1].true_pixels else NOTHING)
        ),
        ComparisonRow("pixels", tuple(str(side.true_pixels) if side.true_pixels else NOTHING for side in sides)),
        ComparisonRow("endpoint error, mean [px]", tuple(_px(side.epe_px) for side in sides)),
        ComparisonRow("endpoint error, median [px]", tuple(_px(side.median_px) for side in sides)),
        ComparisonRow("Fl: above 3 px and 5 %", tuple(_share(side.outliers) for side in sides)),
        ComparisonRow("estimated", tuple(_share(side.density) for side in sides)),
    ]
    for band, (low, high) in BANDS_PX.items():
        reach = f"{low:g} px and more" if high == float("inf") else f"{low:g} to {high:g} px"
        values = tuple(_px(side.band_epe_px(band)) for side in sides)
        rows.append(ComparisonRow(f"mean where the flow is {reach} [px]", values))
    return rows


def describe_flow(score: FlowScore) -> Report:
    """All of it for JSON; null where there is no such pixel."""
    return {
        "all": _describe(score.all),
        "not_occluded": _describe(score.visible) if score.visible.true_pixels else None,
        "by_image": {name: {"epe_px": epe, "outliers": fl} for name, (epe, fl) in score.by_image.items()},
    }


def _describe(error: FlowError) -> Report:
    return {
        "pixels": error.true_pixels,
        "epe_px": error.epe_px,
        "median_px": error.median_px,
        "outliers": error.outliers,
        "density": error.density,
        "epe_px_by_band": {band: error.band_epe_px(band) for band in BANDS_PX},
    }


def _px(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"


def _share(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2%}"
