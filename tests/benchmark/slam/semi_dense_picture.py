# SPDX-License-Identifier: Apache-2.0
"""Pictures of a semi-dense map, to look at."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.mapstore import sim3
from tests.benchmark.slam.semi_dense_run import SemiDenseClouds

Image = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

NEAR_M, FAR_M = 3.0, 80.0
TINT_BY_STATE = np.array([[1, 1, 1], [0.2, 0.8, 1], [0.2, 0.2, 1], [0.6, 0.8, 1], [0.6, 0.8, 1]])
"""BGR; of MotionState"""


def depth_picture(clouds: SemiDenseClouds, images: list[Path], intrinsics: Floats, scale: float) -> Image:
    """Two keyframes with their points over their images, near red, far blue, on a logarithmic scale."""
    keyframes = sorted(clouds.of_keyframe)
    rows = []
    for number in (keyframes[len(keyframes) // 4], keyframes[len(keyframes) // 2]):
        position = clouds.of_keyframe[number]["position"].astype(np.float64)
        picture = np.asarray(cv2.imread(str(images[clouds.frame_of_keyframe[number]])), np.uint8) // 2
        projected = position @ intrinsics.T
        column, row = np.rint(projected[:, :2] / projected[:, 2:]).astype(int).T
        depth_m = position[:, 2] * clouds.pose_of_keyframe[number][7] * scale
        nearness = np.clip(np.log(FAR_M / depth_m) / np.log(FAR_M / NEAR_M), 0, 1)
        colours = cv2.applyColorMap(np.rint(nearness * 255).astype(np.uint8)[:, None], cv2.COLORMAP_JET)
        picture[row, column] = colours[:, 0]
        rows.append(picture)
    return np.vstack(rows)


def cloud_picture(clouds: SemiDenseClouds, scale: float, width: int = 1280) -> Image:
    """All points in their grey, those on objects tinted: seen from behind and above, from the road, and from above."""
    positions, greys, states = _points_in_map(clouds, scale)
    keyframes = sorted(clouds.of_keyframe)
    cameras = np.array([clouds.pose_of_keyframe[number][:3] for number in keyframes]) * scale
    first, last = cameras[len(cameras) // 3], cameras[2 * len(cameras) // 3]
    ahead = (last - first) / np.linalg.norm(last - first)
    up = np.array([0.0, -1.0, 0.0])  # the first camera's frame: y points down
    colours = np.clip((greys[:, None] + 30.0) * TINT_BY_STATE[states], 0, 255).astype(np.uint8)
    middle, height = cameras.mean(axis=0), np.ptp(cameras, axis=0).max() + 70
    low = positions[:, 1] < cameras[:, 1].max() + 4
    views = [
        (first - 18 * ahead + 14 * up, first + 20 * ahead, 620, 700.0),
        (first - 2 * ahead, first + 20 * ahead, 400, 720.0),
        (middle + height * up + 0.01 * height * ahead, middle, 900, 900.0),
    ]
    cloud = (positions[low], colours[low])
    return np.vstack([_render(cloud, eye, at, (width, rows), focal) for eye, at, rows, focal in views])


def _points_in_map(clouds: SemiDenseClouds, scale: float) -> tuple[Floats, npt.NDArray[np.uint8], npt.NDArray[np.intp]]:
    parts = sorted(clouds.of_keyframe.items())
    positions = [
        sim3.transform(np.broadcast_to(clouds.pose_of_keyframe[number], (len(cloud["grey"]), 8)), cloud["position"])
        for number, cloud in parts
    ]
    greys = np.concatenate([cloud["grey"] for _, cloud in parts])
    return np.concatenate(positions) * scale, greys, np.concatenate([cloud["state"] for _, cloud in parts]).astype(int)


def _render(cloud: tuple[Floats, Image], eye: Floats, at: Floats, size: tuple[int, int], focal_px: float) -> Image:
    positions, colours = cloud
    forward = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross([0.0, 1.0, 0.0], forward)
    right /= np.linalg.norm(right)
    in_camera = (positions - eye) @ np.stack([right, np.cross(forward, right), forward]).T
    ahead = in_camera[:, 2] > 0.5
    in_camera, colours = in_camera[ahead], colours[ahead]
    width, height = size
    column, row = np.rint(in_camera[:, :2] / in_camera[:, 2:] * focal_px + (width / 2, height / 2)).astype(int).T
    inside = (column >= 0) & (row >= 0) & (column < width - 1) & (row < height - 1)
    order = np.flatnonzero(inside)[np.argsort(-in_camera[inside, 2], kind="stable")]
    picture = np.zeros((height, width, 3), np.uint8)
    for right_by in (0, 1):
        for down_by in (0, 1):
            picture[row[order] + down_by, column[order] + right_by] = colours[order]
    return picture
