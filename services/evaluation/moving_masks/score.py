# SPDX-License-Identifier: Apache-2.0
"""Moving masks of a data set: all frames together, each frame alone, and the flag of instances where it is known."""

from dataclasses import dataclass
from pathlib import Path

from services.evaluation.moving_masks.flag import LabelledFlagEvaluator
from services.evaluation.moving_masks.inputs import MovingMaskFolder, paired_frames, read_pairs
from services.evaluation.moving_masks.iou import MovingMaskScore, compare_masks, sum_of
from services.evaluation.progress import Progress, silent
from services.evaluation.run.moving_flag import MovingFlagScore
from services.runtime.errors import InputError


@dataclass(frozen=True)
class FlagRules:
    """Which instances the flag is asked of, and from which IoU on two are the same."""

    minimum_iou: float = 0.5
    minimum_height_px: float = 40.0


@dataclass(frozen=True)
class MovingMaskResult:
    """`flag` is None where the folders do not say which instance moves.

    `missing` names true frames without a found mask, in which nothing was said to move; `without_truth` counts found
    frames that the truth does not have.
    """

    total: MovingMaskScore
    by_frame: dict[str, MovingMaskScore]
    flag: MovingFlagScore | None
    missing: tuple[str, ...]
    without_truth: int


def score_moving_masks(
    found: Path, truth: Path, rules: FlagRules | None = None, progress: Progress = silent
) -> MovingMaskResult:
    """Score a folder of masks against another.

    Raises:
        InputError: as the folders do, no frame in common, or masks of different sizes; names frame and both sizes.
    """
    rules = rules or FlagRules()
    folders = MovingMaskFolder(truth), MovingMaskFolder(found)
    frames, missing = paired_frames(*folders)
    flag = LabelledFlagEvaluator(rules.minimum_iou, rules.minimum_height_px)
    flagged = all(folder.has_instances for folder in folders)
    scores = {}
    for frame, true, seen in read_pairs(*folders, frames, progress):
        try:
            scores[frame] = compare_masks(frame, true.mask, seen.mask)
        except InputError as error:
            raise InputError(f"{found}: {error}") from None
        if flagged and true.labels is not None and seen.labels is not None:
            flag.add((true.labels, true.instances), (seen.labels, seen.instances))
    binary = any(folder.is_binary for folder in folders)
    return MovingMaskResult(
        total=sum_of(scores.values(), binary=binary),
        by_frame={frame: score.as_binary() if binary else score for frame, score in scores.items()},
        flag=flag.score if flagged else None,
        missing=missing,
        without_truth=len(set(folders[1].frames) - set(frames)),
    )
