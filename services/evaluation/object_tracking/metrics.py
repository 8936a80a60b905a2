# SPDX-License-Identifier: Apache-2.0
"""Object tracking by trackeval's metrics: HOTA, CLEAR MOT and identity.

Sources: Luiten et al., "HOTA: A Higher Order Metric for Evaluating Multi-Object Tracking", IJCV 2021; Bernardin and
Stiefelhagen, "Evaluating Multiple Object Tracking Performance: The CLEAR MOT Metrics", 2008; Ristani et al.,
"Performance Measures and a Data Set for Multi-Target, Multi-Camera Tracking", ECCV workshops 2016.
"""

import contextlib
import io
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from services.runtime.errors import ResourceError

HOTA_IOUS = tuple(round(0.05 * step, 2) for step in range(1, 20))
"""HOTA is the mean over these; MOTA, MOTP and IDF1 match at an IoU of 0.5."""


@dataclass(frozen=True)
class MatchedFrame:
    """The objects of one class in one frame: ids that last, (G,) and (F,), and the IoU of every pair, (G, F)."""

    true_ids: npt.NDArray[np.int64]
    found_ids: npt.NDArray[np.int64]
    iou: npt.NDArray[np.float64]


@dataclass(frozen=True)
class TrackingScore:
    """Of one class; shares in 0..1 (MOTA can be below 0), counts of objects in frames where no other is said.

    `hota` is the geometric mean of `det_a` (are the objects found?) and `ass_a` (do their ids last?) at every IoU of
    HOTA_IOUS, averaged; `loc_a` and `motp` say how well matched masks or boxes cover each other.
    """

    hota: float
    det_a: float
    ass_a: float
    loc_a: float
    mota: float
    motp: float
    idf1: float
    id_switches: int
    false_positives: int
    false_negatives: int
    fragmentations: int
    mostly_tracked: int
    """true objects, of `true_objects`, found in more than 80 % of their frames"""
    mostly_lost: int
    """in less than 20 %"""
    true_objects: int
    true_detections: int
    hota_by_iou: tuple[float, ...]
    det_a_by_iou: tuple[float, ...]
    ass_a_by_iou: tuple[float, ...]


@dataclass(frozen=True)
class SequenceResult:
    """trackeval's own result of one sequence by metric, to be combined with those of others."""

    by_metric: Mapping[str, dict[str, Any]]
    true_objects: int
    true_detections: int


class ObjectTrackingEvaluator:
    """Scores sequences of one class.

    Raises:
        ResourceError: trackeval is not installed.
    """

    def __init__(self) -> None:
        metrics = _trackeval_metrics()
        with _quiet():
            self._metrics = {
                "hota": metrics.HOTA(),
                "clear": metrics.CLEAR({"PRINT_CONFIG": False}),
                "identity": metrics.Identity({"PRINT_CONFIG": False}),
            }

    def sequence(self, frames: Sequence[MatchedFrame]) -> SequenceResult:
        """Score one sequence, its frames in order; those without any object change nothing."""
        true_ids, true_of_frame = _numbered([frame.true_ids for frame in frames])
        found_ids, found_of_frame = _numbered([frame.found_ids for frame in frames])
        true_detections = sum(ids.size for ids in true_of_frame)
        data = {
            "num_timesteps": len(frames),
            "num_gt_ids": true_ids,
            "num_tracker_ids": found_ids,
            "num_gt_dets": true_detections,
            "num_tracker_dets": sum(ids.size for ids in found_of_frame),
            "gt_ids": true_of_frame,
            "tracker_ids": found_of_frame,
            "similarity_scores": [frame.iou for frame in frames],
        }
        with _quiet():
            results = {name: metric.eval_sequence(data) for name, metric in self._metrics.items()}
        return SequenceResult(results, true_ids, true_detections)

    def combined(self, sequences: Sequence[SequenceResult]) -> TrackingScore:
        """The score over all sequences: counts are summed before anything is divided."""
        with _quiet():
            hota, clear, identity = (
                metric.combine_sequences({str(n): sequence.by_metric[name] for n, sequence in enumerate(sequences)})
                for name, metric in self._metrics.items()
            )
        return TrackingScore(
            hota=float(np.mean(hota["HOTA"])),
            det_a=float(np.mean(hota["DetA"])),
            ass_a=float(np.mean(hota["AssA"])),
            loc_a=float(np.mean(hota["LocA"])),
            mota=float(clear["MOTA"]),
            motp=float(clear["MOTP"]),
            idf1=float(identity["IDF1"]),
            id_switches=int(clear["IDSW"]),
            false_positives=int(clear["CLR_FP"]),
            false_negatives=int(clear["CLR_FN"]),
            fragmentations=int(clear["Frag"]),
            mostly_tracked=int(clear["MT"]),
            mostly_lost=int(clear["ML"]),
            true_objects=sum(sequence.true_objects for sequence in sequences),
            true_detections=sum(sequence.true_detections for sequence in sequences),
            hota_by_iou=tuple(hota["HOTA"].tolist()),
            det_a_by_iou=tuple(hota["DetA"].tolist()),
            ass_a_by_iou=tuple(hota["AssA"].tolist()),
        )


def _numbered(ids_of_frame: Sequence[npt.NDArray[np.int64]]) -> tuple[int, list[npt.NDArray[np.int64]]]:
    """How many ids there are, and each frame's ids numbered from 0."""
    ids = np.unique(np.concatenate([*ids_of_frame, np.zeros(0, dtype=np.int64)]))
    return ids.size, [np.searchsorted(ids, frame) for frame in ids_of_frame]


def _trackeval_metrics() -> Any:
    try:
        with _quiet():
            from trackeval import metrics
    except ImportError as error:
        # without its dependencies, all of which are here but for a second OpenCV that needs a display's libraries
        raise ResourceError(
            f"trackeval is not installed ({error}), expected it for object tracking: pip install --no-deps trackeval"
        ) from None
    return metrics


@contextlib.contextmanager
def _quiet() -> Any:
    """trackeval prints what it does and leans on what numpy is about to drop."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        yield
