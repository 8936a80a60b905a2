# SPDX-License-Identifier: Apache-2.0
"""Flow over a data set: all pixels, those that both images see, and each image's own error."""

from dataclasses import dataclass, field

from services.evaluation.optical_flow.error import FlowError, endpoint_error
from services.evaluation.optical_flow.inputs import FlowPair, FlowPairs, read_flow
from services.evaluation.progress import Progress, silent
from services.runtime.errors import InputError


@dataclass
class FlowScore:
    """`visible` counts pixels that are not occluded; it stays empty where nobody said which these are."""

    all: FlowError = field(default_factory=FlowError)
    visible: FlowError = field(default_factory=FlowError)
    by_image: dict[str, tuple[float | None, float | None]] = field(default_factory=dict)
    """mean endpoint error in px and Fl of each image, all pixels"""


def flow_score(pairs: FlowPairs, progress: Progress = silent) -> FlowScore:
    """Score every pair.

    Raises:
        InputError: images of different sizes, truths without a known pixel, or what the formats refuse.
    """
    score = FlowScore()
    for pair in progress(pairs.pairs, "comparing flow"):
        try:
            _add(score, pair)
        except InputError as error:
            named = any(str(path) in str(error) for path in (pair.found, pair.truth, pair.visible_truth) if path)
            raise InputError(str(error) if named else f"{pair.found}: {error}") from None
    if not score.all.true_pixels:
        raise InputError(f"{pairs.pairs[0].truth}: no pixel with a known flow, expected at least one")
    return score


def _add(score: FlowScore, pair: FlowPair) -> None:
    truth, found = read_flow(pair.truth), read_flow(pair.found)
    error = endpoint_error(truth, found)
    alone = FlowError()
    alone.add(error, truth, truth.valid)
    score.by_image[pair.name] = (alone.epe_px, alone.outliers)
    score.all.add(error, truth, truth.valid)
    if pair.visible_truth is not None:
        visible = read_flow(pair.visible_truth)
        endpoint_error(truth, visible)  # refuses another size
        score.visible.add(error, truth, truth.valid & visible.valid)
