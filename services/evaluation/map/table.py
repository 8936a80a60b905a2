# SPDX-License-Identifier: Apache-2.0
"""The error of a map as text, and as what `--json` holds."""

from dataclasses import asdict

from services.evaluation.map.error import LABELS, DistanceError, MapError, MapErrorRules
from services.evaluation.run.outcome import Report

SAID = (*(label.name.lower() for label in LABELS), "other")


def map_rows(error: MapError, rules: MapErrorRules) -> list[tuple[str, str]]:
    """(what, value) pairs, in the order to show them."""
    covered = f"{error.compared} of {error.landmarks} landmarks ({_share(error.compared, error.landmarks)})"
    rows = [
        ("compared", f"{covered}, {error.surface_points} points of surface"),
        *_distance_rows("accuracy (map to surface)", error.accuracy, rules.near_m),
        *_distance_rows("completeness (surface to map)", error.completeness, rules.near_m),
        ("chamfer, mean of both means [m]", f"{error.chamfer_m:.3f}"),
    ]
    for label, counts in zip(LABELS, error.confusion.tolist(), strict=True):
        said = ", ".join(f"{count} {name}" for name, count in zip(SAID, counts, strict=True))
        rows.append((f"truly {label.name.lower()}, called", said))
    on_surface, off_surface = int(error.confusion.sum()), int(error.off_surface.sum())
    near = f"{on_surface} of {on_surface + off_surface} within {rules.label_within_m:g} m of a surface"
    rows.append(("label accuracy", f"{_number(error.label_accuracy)} ({near})"))
    for label in LABELS:
        shares = f"precision {_number(error.precision(label))}, recall {_number(error.recall(label))}"
        rows.append((f"called {label.name.lower()}", shares))
    if not error.moving_known:
        rows.append(("moving", "not in this surface: landmarks called moving are left out of the labels"))
    return rows


def describe_map_error(error: MapError, rules: MapErrorRules) -> Report:
    """In plain dictionaries and numbers."""
    return {
        "rules": asdict(rules),
        "landmarks": error.landmarks,
        "compared": error.compared,
        "surface_points": error.surface_points,
        "accuracy": asdict(error.accuracy),
        "completeness": asdict(error.completeness),
        "chamfer_m": error.chamfer_m,
        "labels": list(SAID),
        "confusion": error.confusion.tolist(),
        "off_surface": error.off_surface.tolist(),
        "moving_known": error.moving_known,
        "label_accuracy": error.label_accuracy,
        "precision": {label.name.lower(): error.precision(label) for label in LABELS},
        "recall": {label.name.lower(): error.recall(label) for label in LABELS},
    }


def _distance_rows(name: str, error: DistanceError, near_m: float) -> list[tuple[str, str]]:
    values = f"mean {error.mean_m:.3f}, median {error.median_m:.3f}, within {near_m:g} m {error.share_near:.1%}"
    return [(f"{name} [m]", f"{values} (of {error.points} points)")]


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.1%}" if whole else "none"


def _number(value: float | None) -> str:
    return "undefined" if value is None else f"{value:.3f}"
