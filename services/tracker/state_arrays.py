# SPDX-License-Identifier: Apache-2.0
"""The tracker's objects as named arrays, exactly, so that a killed service goes on where it was."""

import numpy as np
import numpy.typing as npt

from schemas.records import MotionState
from services.tracker.mask_patch import MaskPatch
from services.tracker.motion_filter import MotionBelief
from services.tracker.track_lifecycle import TrackedObject

Arrays = dict[str, npt.NDArray[np.generic]]


def arrays_of_objects(objects: tuple[TrackedObject, ...], next_id: int) -> Arrays:
    """Arrays that `objects_of_arrays` makes the same objects of. Masks lie one behind the other, a bit a pixel."""
    scores = [
        (row, category, score) for row, known in enumerate(objects) for category, score in known.category_scores.items()
    ]
    masks = [known.patch.mask.ravel() for known in objects]
    return {
        "next_id": np.array(next_id, np.int64),
        "whole": np.array(
            [(known.object_id, known.observed_frames, known.unseen_frames, known.belief.state) for known in objects],
            np.int64,
        ).reshape(-1, 4),
        "real": np.array(
            [
                (known.score, *known.box_px, *known.velocity_px, known.growth, known.belief.log_odds)
                for known in objects
            ],
            np.float64,
        ).reshape(-1, 9),
        "score_row": np.array([row for row, _, _ in scores], np.int64),
        "score_category": np.array([category for _, category, _ in scores], np.str_),
        "score": np.array([score for _, _, score in scores], np.float64),
        "mask_place": np.array(
            [(known.patch.x, known.patch.y, *known.patch.mask.shape) for known in objects], np.int64
        ).reshape(-1, 4),
        "mask_bits": np.packbits(np.concatenate(masks)) if masks else np.empty(0, np.uint8),
    }


def objects_of_arrays(arrays: Arrays) -> tuple[tuple[TrackedObject, ...], int]:
    """The objects and the next id that `arrays_of_objects` was given."""
    whole, real = np.asarray(arrays["whole"], np.int64), np.asarray(arrays["real"], np.float64)
    bits = np.unpackbits(np.asarray(arrays["mask_bits"], np.uint8)).astype(bool)
    rows, scores = np.asarray(arrays["score_row"], np.int64), np.asarray(arrays["score"], np.float64)
    objects, start = [], 0
    for row, (x, y, height, width) in enumerate(np.asarray(arrays["mask_place"], np.int64)):
        mask = bits[start : start + height * width].reshape(height, width)
        start += height * width
        object_id, observed_frames, unseen_frames, state = (int(value) for value in whole[row])
        score, box_x, box_y, box_width, box_height, right, down, growth, log_odds = (float(v) for v in real[row])
        objects.append(
            TrackedObject(
                object_id,
                {str(arrays["score_category"][i]): float(scores[i]) for i in np.flatnonzero(rows == row)},
                score,
                MaskPatch(int(x), int(y), mask),
                (box_x, box_y, box_width, box_height),
                (right, down),
                growth,
                MotionBelief(log_odds, MotionState(state)),
                observed_frames,
                unseen_frames,
            )
        )
    return tuple(objects), int(np.asarray(arrays["next_id"]))
