# SPDX-License-Identifier: Apache-2.0
"""How right a map is: how far its landmarks are from the true surface, and whether they are called what they are."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from schemas.records import MotionState
from services.formats.point_cloud import LabelledPoints
from services.runtime.errors import InputError

LABELS = (MotionState.STATIC, MotionState.NON_MOVING, MotionState.MOVING)


@dataclass(frozen=True)
class MapErrorRules:
    """What is compared, and how near is near; all in metres."""

    within_m: float = 40.0
    """of the true path: landmarks and surface farther away are left out"""
    near_m: float = 0.2
    """a point this near to the other side counts as met"""
    label_within_m: float = 0.5
    """a landmark takes the label of the nearest surface point, one farther from any than this has none"""

    def __post_init__(self) -> None:
        for name, value in (("within", self.within_m), ("near", self.near_m), ("label-within", self.label_within_m)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{name} {value:g} m, expected a number above 0")


@dataclass(frozen=True)
class DistanceError:
    """Distances of `points` to the nearest point of the other side."""

    points: int
    mean_m: float
    median_m: float
    share_near: float

    @classmethod
    def of(cls, distance_m: npt.NDArray[np.float64], near_m: float) -> "DistanceError":
        """Summarise (N,) distances, N > 0."""
        mean, median = float(distance_m.mean()), float(np.median(distance_m))
        return cls(len(distance_m), mean, median, float((distance_m <= near_m).mean()))


@dataclass(frozen=True)
class MapError:
    """`accuracy` is from landmarks to the surface, `completeness` from the surface to landmarks; of what stands alone,
    since what moves has a place only at a time.

    `confusion` (3, 4): rows are the truth (static, non_moving, moving), columns what the map says (the same, then
    undecided or potentially dynamic); `off_surface` (4,) landmarks by what the map says that are near no surface. Where
    the surface holds nothing that moves (`moving_known` false), landmarks that the map calls moving are in neither.
    `landmarks` are all of the map, `compared` those within the rules' reach.
    """

    landmarks: int
    compared: int
    surface_points: int
    accuracy: DistanceError
    completeness: DistanceError
    confusion: npt.NDArray[np.int64]
    off_surface: npt.NDArray[np.int64]
    moving_known: bool
    landmark_distance_m: npt.NDArray[np.float64]
    """(L,) of every landmark to the standing surface, NaN for those that were not compared or are called moving"""

    @property
    def chamfer_m(self) -> float:
        """The mean of the two mean distances."""
        return (self.accuracy.mean_m + self.completeness.mean_m) / 2

    @property
    def label_accuracy(self) -> float | None:
        """The share of right labels among the landmarks that are near a surface. None where there are none."""
        total = int(self.confusion.sum())
        return int(np.trace(self.confusion)) / total if total else None

    def precision(self, label: MotionState) -> float | None:
        """Right among the landmarks called so. None where there are none."""
        column = int(self.confusion[:, LABELS.index(label)].sum())
        return int(self.confusion[LABELS.index(label), LABELS.index(label)]) / column if column else None

    def recall(self, label: MotionState) -> float | None:
        """Called so among the landmarks that are so. None where there are none."""
        row = int(self.confusion[LABELS.index(label)].sum())
        return int(self.confusion[LABELS.index(label), LABELS.index(label)]) / row if row else None


def map_error(
    landmarks: LabelledPoints,
    surface: LabelledPoints,
    path_m: npt.NDArray[np.float64] | None = None,
    rules: MapErrorRules | None = None,
) -> MapError:
    """Compare a map with the true surface, both in the surface's frame, metres.

    `path_m` (N, 3) are true camera positions; without them everything is compared. Raises InputError where one side
    has nothing that stands within the reach.
    """
    rules = rules or MapErrorRules()
    if (surface.state >= len(LABELS)).any():
        raise InputError(f"{surface.name}: a surface point of state {surface.state.max()}, expected 0, 1 or 2")
    surface = surface.chosen(_within(surface.position, path_m, rules.within_m))
    reached = _within(landmarks.position, path_m, rules.within_m)
    standing = landmarks.chosen(reached & (landmarks.state != MotionState.MOVING))
    standing_surface = surface.chosen(surface.state != MotionState.MOVING)
    reach = "" if path_m is None else f" within {rules.within_m:g} m of the path"
    for points in (standing, standing_surface):
        if len(points) == 0:
            raise InputError(f"{points.name}: no point of what stands{reach}, expected one at least")
    accuracy_m, _ = cKDTree(standing_surface.position).query(standing.position)
    completeness_m, _ = cKDTree(standing.position).query(standing_surface.position)
    moving_known = bool((surface.state == MotionState.MOVING).any())
    labelled = landmarks.chosen(reached) if moving_known else standing
    confusion, off_surface = _confusion(labelled, surface, rules.label_within_m)
    distance = np.full(len(landmarks), np.nan)
    distance[reached & (landmarks.state != MotionState.MOVING)] = accuracy_m
    return MapError(
        landmarks=len(landmarks),
        compared=int(reached.sum()),
        surface_points=len(surface),
        accuracy=DistanceError.of(accuracy_m, rules.near_m),
        completeness=DistanceError.of(completeness_m, rules.near_m),
        confusion=confusion,
        off_surface=off_surface,
        moving_known=moving_known,
        landmark_distance_m=distance,
    )


def _within(
    position: npt.NDArray[np.float64], path_m: npt.NDArray[np.float64] | None, within_m: float
) -> npt.NDArray[np.bool_]:
    if path_m is None or len(position) == 0:
        return np.ones(len(position), dtype=bool)
    distance, _ = cKDTree(path_m).query(position, distance_upper_bound=within_m)
    within: npt.NDArray[np.bool_] = np.isfinite(distance)
    return within


def _confusion(
    landmarks: LabelledPoints, surface: LabelledPoints, within_m: float
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    distance, nearest = cKDTree(surface.position).query(landmarks.position)
    said = np.minimum(landmarks.state, len(LABELS)).astype(np.int64)
    on_surface = distance <= within_m
    true = surface.state[nearest[on_surface]].astype(np.int64)
    counts = np.bincount(true * (len(LABELS) + 1) + said[on_surface], minlength=len(LABELS) * (len(LABELS) + 1))
    off = np.bincount(said[~on_surface], minlength=len(LABELS) + 1)
    return counts.reshape(len(LABELS), len(LABELS) + 1).astype(np.int64), off.astype(np.int64)
