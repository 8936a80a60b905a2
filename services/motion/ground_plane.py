# SPDX-License-Identifier: Apache-2.0
"""The road, as the plane that gives every pixel the inverse depth a thing standing there would have."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.motion.flow_samples import FlowSamples
from services.motion.two_view import CameraMotion, FloatArray, Parallax, measure_parallax

DOWN = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class GroundOptions:
    """How the road is told from the rest of the background."""

    least_samples: int = 40
    most_samples: int = 2000
    least_along_px: float = 2.5
    """that a sample on the plane must move: near the horizon everything agrees with it"""
    band_px: float = 0.5
    """a sample belongs to the road when its displacement agrees to this many px plus `band_share` of it"""
    band_share: float = 0.05
    largest_tilt: float = 0.2
    """rad between the road's normal and the camera's y axis"""
    normal_memory: float = 0.9
    """share of the normal of the images before in that of this one"""


@dataclass(frozen=True)
class GroundPlane:
    """normal . X = height in the current camera's optical frame; `height` in baselines, `normal` (3,) unit, down."""

    normal: FloatArray
    height: float
    samples: int
    agreement: float
    """share of the samples below the horizon and near the lane that lie on the plane"""

    def inverse_depth(self, points: FloatArray) -> FloatArray:
        """1 / baseline, (N,), where rays through normalised `points` (N, 2) meet the plane; <= 0 above the horizon."""
        return np.asarray((points @ self.normal[:2] + self.normal[2]) / self.height)


def fit_ground(
    samples: FlowSamples,
    background: npt.NDArray[np.bool_],
    motion: CameraMotion,
    normal_before: FloatArray | None = None,
    options: GroundOptions | None = None,
) -> GroundPlane | None:
    """Fit the plane to background samples below the horizon; None where too few agree, or without a baseline.

    The height that most samples agree with is sought first, the normal being that of the images before (or the camera's
    y axis), and both are then refined by least squares on the samples that agree.
    """
    options = options or GroundOptions()
    if not motion.has_baseline:
        return None
    normal = DOWN if normal_before is None else normal_before
    below = samples.current @ normal[:2] + normal[2]
    chosen = np.flatnonzero(background & (below > 0.04))
    if len(chosen) < options.least_samples:
        return None
    chosen = chosen[:: 1 + len(chosen) // options.most_samples]
    points = samples.where(chosen)
    parallax = measure_parallax(motion, points.current, points.previous)
    usable = parallax.along * points.focal_px > options.least_along_px
    if int(usable.sum()) < options.least_samples:
        return None
    height = _commonest_height(below[chosen][usable], parallax.inverse_depth[usable], points.current[usable])
    plane = normal / height
    agrees = _on_plane(plane, points, parallax, options)
    for _ in range(4):
        if int(agrees.sum()) < options.least_samples:
            return None
        plane = _least_squares(plane, points, parallax, agrees, options)
        agrees = _on_plane(plane, points, parallax, options)
    length = float(np.linalg.norm(plane))
    normal = plane / length
    if np.arccos(np.clip(normal @ DOWN, -1.0, 1.0)) > options.largest_tilt:
        return None
    lane = np.abs(points.current[:, 0]) < 2.0 * below[chosen] + 0.05
    return GroundPlane(normal, 1.0 / length, int(agrees.sum()), float(np.mean(agrees[lane])) if lane.any() else 0.0)


def blend_normal(before: FloatArray | None, now: FloatArray, memory: float) -> FloatArray:
    """The normal to start the next image with: the road turns slowly against the camera, one fit is noisy."""
    if before is None:
        return now
    blended = memory * before + (1.0 - memory) * now
    return np.asarray(blended / np.linalg.norm(blended))


def _near_lane(below: FloatArray, points: FloatArray) -> FloatArray:
    """Weights 0..1: kerbs, hedges and walls stand beside the lane, and always make the ground look too near."""
    return np.asarray(np.exp(-0.5 * (points[:, 0] / (1.5 * np.maximum(below, 0.0) + 0.1)) ** 2))


def _commonest_height(below: FloatArray, inverse_depth: FloatArray, points: FloatArray) -> float:
    """Mode of log height over the samples."""
    logs = np.log(below / inverse_depth)
    weights = _near_lane(below, points)
    order = np.argsort(logs, kind="stable")
    logs, total = logs[order], np.concatenate(([0.0], np.cumsum(weights[order])))
    ends = np.searchsorted(logs, logs + 0.1, side="right")
    start = int(np.argmax(total[ends] - total[:-1]))
    return float(np.exp(np.median(logs[start : ends[start]])))


def _on_plane(
    plane: FloatArray, points: FlowSamples, parallax: Parallax, options: GroundOptions
) -> npt.NDArray[np.bool_]:
    scale = parallax.gain * points.focal_px
    expected_px = (points.current @ plane[:2] + plane[2]) * scale
    band_px = options.band_px + options.band_share * expected_px
    # chosen by what the plane says, not by what was measured: that would keep the errors to one side only
    return np.asarray(
        (np.abs(parallax.inverse_depth * scale - expected_px) < band_px) & (expected_px > options.least_along_px)
    )


def _least_squares(
    plane: FloatArray,
    points: FlowSamples,
    parallax: Parallax,
    agrees: npt.NDArray[np.bool_],
    options: GroundOptions,
) -> FloatArray:
    """Weighted fit in px, held lightly to the present normal where the samples say little about it."""
    scale = parallax.gain * points.focal_px
    below = points.current @ plane[:2] + plane[2]
    off = (parallax.inverse_depth - below) * scale / (options.band_px + options.band_share * below * scale)
    weight = (
        scale
        / (1.0 + below * scale / 10.0)
        * (1.0 - off**2)
        * _near_lane(below / np.linalg.norm(plane), points.current)
    )
    weight = weight[agrees]
    rows = np.column_stack((points.current[agrees], np.ones(int(agrees.sum())))) * weight[:, None]
    normal_matrix = rows.T @ rows
    hold = np.eye(3) * 0.02 * float(np.trace(normal_matrix))
    hold -= np.outer(plane, plane) * (hold[0, 0] / float(plane @ plane))
    right = rows.T @ (parallax.inverse_depth[agrees] * weight) + hold @ plane
    return np.asarray(np.linalg.solve(normal_matrix + hold, right))
