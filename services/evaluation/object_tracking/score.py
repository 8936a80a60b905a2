# SPDX-License-Identifier: Apache-2.0
"""Object tracking over sequences and classes."""

from collections.abc import Sequence
from dataclasses import dataclass

from services.evaluation.object_tracking.inputs import SequencePair
from services.evaluation.object_tracking.matching import match_sequence
from services.evaluation.object_tracking.metrics import ObjectTrackingEvaluator, TrackingScore
from services.evaluation.progress import Progress, silent


@dataclass(frozen=True)
class ClassScore:
    """One class over all sequences, and in each of them by name."""

    total: TrackingScore
    by_sequence: dict[str, TrackingScore]


def tracking_scores(
    pairs: Sequence[SequencePair], categories: Sequence[str], progress: Progress = silent
) -> dict[str, ClassScore]:
    """Score every class in every sequence, each class by itself.

    Raises:
        InputError: masks of different sizes.
        ResourceError: trackeval is not installed.
    """
    evaluator = ObjectTrackingEvaluator()
    tasks = [(category, pair) for category in categories for pair in pairs]
    results = {
        (category, pair.truth.name): evaluator.sequence(match_sequence(pair.truth, pair.found, category))
        for category, pair in progress(tasks, "matching objects")
    }
    return {
        category: ClassScore(
            total=evaluator.combined([results[category, pair.truth.name] for pair in pairs]),
            by_sequence={p.truth.name: evaluator.combined([results[category, p.truth.name]]) for p in pairs},
        )
        for category in categories
    }
