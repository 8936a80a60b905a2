# SPDX-License-Identifier: Apache-2.0
"""The rotation, translation and scale that bring one trajectory onto another."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError

MINIMUM_POSES = 3

Points = npt.NDArray[np.float64]


class Alignment(StrEnum):
    """What of the estimate's frame is free: nothing, a rigid motion, or a rigid motion and the scale."""

    NONE = "none"
    SE3 = "se3"
    SIM3 = "sim3"


@dataclass(frozen=True)
class Similarity:
    """target_from_source: p_target = scale * rotation @ p_source + translation."""

    rotation: npt.NDArray[np.float64]
    translation: npt.NDArray[np.float64]
    scale: float = 1.0

    @classmethod
    def identity(cls) -> "Similarity":
        """The frame left as it is."""
        return cls(np.eye(3), np.zeros(3))

    def points(self, source: Points) -> Points:
        """Bring (N, 3) points into the target frame."""
        return self.scale * source @ self.rotation.T + self.translation

    def poses(self, source_from_camera: Points) -> Points:
        """Bring (N, 4, 4) poses into the target frame; they stay rigid, only their positions are scaled."""
        poses = source_from_camera.copy()
        poses[:, :3, :3] = self.rotation @ source_from_camera[:, :3, :3]
        poses[:, :3, 3] = self.points(source_from_camera[:, :3, 3])
        return poses


def align(source: Points, target: Points, alignment: Alignment) -> Similarity:
    """The least-squares target_from_source over paired points, (N, 3) each.

    Umeyama, "Least-squares estimation of transformation parameters between two point patterns", PAMI 1991, as in
    algorithm 6 of the thesis; with `Alignment.SE3` the scale stays 1. Points on one line leave the rotation about that
    line free, which changes no distance between them. Raises InputError for fewer than 3 pairs, for a source that is
    all at one place, and with `Alignment.SIM3` for such a target, on which the scale would be 0.
    """
    if alignment is Alignment.NONE:
        return Similarity.identity()
    if len(source) < MINIMUM_POSES:
        raise InputError(f"{len(source)} poses in common with the ground truth, expected at least {MINIMUM_POSES}")
    source_mean, target_mean = source.mean(axis=0), target.mean(axis=0)
    source_centred, target_centred = source - source_mean, target - target_mean
    source_variance = _variance(source_centred)
    if _is_one_place(source_variance, source_mean):
        raise InputError(f"all {len(source)} estimated positions are at one place: nothing to align")
    if alignment is Alignment.SIM3 and _is_one_place(_variance(target_centred), target_mean):
        raise InputError(f"all {len(target)} true positions are at one place: they give no scale")
    covariance = target_centred.T @ source_centred / len(source)
    u, singular_values, vt = np.linalg.svd(covariance)
    reflection_guard = np.ones(3)
    if np.linalg.det(u) * np.linalg.det(vt) < 0.0:
        reflection_guard[2] = -1.0
    rotation = (u * reflection_guard) @ vt
    scale = 1.0
    if alignment is Alignment.SIM3:
        scale = float(singular_values @ reflection_guard) / source_variance
    return Similarity(rotation, target_mean - scale * rotation @ source_mean, scale)


def _variance(centred: Points) -> float:
    return float(np.square(centred).sum(axis=1).mean())


def _is_one_place(variance: float, mean: Points) -> bool:
    return variance <= float(np.finfo(np.float64).eps) * (1.0 + float(np.square(mean).sum()))
