# SPDX-License-Identifier: Apache-2.0
"""The semi-dense map of one pass of the engine, beside what is true."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import Alignment, align
from tests.benchmark.slam.engine_run import FRAME_NS, EngineRun, Update

DepthOf = Callable[[int], npt.NDArray[np.float32]]
"""Frame index -> true depth (height, width) in metres along the optical axis, 0 where unknown."""


@dataclass(frozen=True)
class Judge:
    """What depths are compared with, of every so many keyframes."""

    name: str
    depth_of: DepthOf
    every: int = 1


_COLUMNS = ("position", "depth_sigma", "grey", "state", "category", "object_id")


@dataclass
class SemiDenseClouds:
    """A keyframe's points by column of the engine's map update, `dense_point_` left out."""

    of_keyframe: dict[int, Update] = field(default_factory=dict)
    frame_of_keyframe: dict[int, int] = field(default_factory=dict)
    pose_of_keyframe: dict[int, npt.NDArray[np.float64]] = field(default_factory=dict)
    """Sim(3) map_from_keyframe (8,)"""

    def take(self, update: Update) -> None:
        """Add the keyframes that an update finished."""
        for number, timestamp_ns, pose in zip(
            update["keyframe_id"].tolist(),
            update["keyframe_timestamp_ns"].tolist(),
            update["keyframe_pose"],
            strict=True,
        ):
            self.frame_of_keyframe[number] = timestamp_ns // FRAME_NS - 1
            self.pose_of_keyframe[number] = pose
        ends = np.cumsum(update["dense_keyframe_points"]).tolist()
        for number, count, end in zip(
            update["dense_keyframe_id"].tolist(), update["dense_keyframe_points"].tolist(), ends, strict=True
        ):
            self.of_keyframe[number] = {name: update[f"dense_point_{name}"][end - count : end] for name in _COLUMNS}

    def points(self) -> int:
        """How many there are."""
        return sum(len(cloud["grey"]) for cloud in self.of_keyframe.values())


def metres_per_unit(run: EngineRun, true_centers_m: npt.NDArray[np.float64]) -> float:
    """Scale of the map by its trajectory (Umeyama 1991)."""
    indices, centers = run.centers()
    return float(align(centers, true_centers_m[indices], Alignment.SIM3).scale)


def simulated_depth(folder: Path) -> DepthOf:
    """Of a data set of `kinemap simulate --formats depth`."""
    paths = sorted(folder.iterdir())
    return lambda index: (cv2.imread(str(paths[index]), cv2.IMREAD_UNCHANGED) / 256).astype(np.float32)


def stereo_depth(left: Path, right: Path, focal_baseline_px_m: float) -> DepthOf:
    """By semi-global matching of rectified images; only where the match from right to left agrees and is certain."""

    def depth(index: int) -> npt.NDArray[np.float32]:
        images = [cv2.imread(str(sorted(folder.iterdir())[index]), cv2.IMREAD_GRAYSCALE) for folder in (left, right)]
        matcher = cv2.StereoSGBM.create(
            0, 128, 5, 8 * 25, 32 * 25, disp12MaxDiff=1, uniquenessRatio=15, speckleWindowSize=200, speckleRange=1
        )
        disparity_px = matcher.compute(*images).astype(np.float32) / 16
        return np.where(disparity_px > 1, focal_baseline_px_m / np.maximum(disparity_px, 1), 0).astype(np.float32)

    return depth


def relative_errors(
    clouds: SemiDenseClouds, intrinsics: npt.NDArray[np.float64], scale: float, judge: Judge
) -> npt.NDArray[np.float64]:
    """(N,) signed errors of the points' depths in their own keyframes, as parts of the true depth where it is known."""
    errors = [np.empty(0)]
    shown = sorted(number for number, cloud in clouds.of_keyframe.items() if len(cloud["grey"]) > 0)
    for number in shown[judge.every // 2 :: judge.every]:
        position = clouds.of_keyframe[number]["position"].astype(np.float64)
        projected = position @ intrinsics.T
        column, row = np.rint(projected[:, :2] / projected[:, 2:]).astype(int).T
        true_m = judge.depth_of(clouds.frame_of_keyframe[number])[row, column].astype(np.float64)
        known = true_m > 0
        depth_m = position[known, 2] * clouds.pose_of_keyframe[number][7] * scale
        errors.append((depth_m - true_m[known]) / true_m[known])
    return np.concatenate(errors)
