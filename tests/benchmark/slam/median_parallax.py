# SPDX-License-Identifier: Apache-2.0
"""When a camera has moved enough for a map to begin: by optical flow and the true rotation."""

import cv2
import numpy as np

from tests.benchmark.slam.sequence_part import SequencePart

_CORNERS = 800


def first_with_parallax(part: SequencePart, parallax_deg: float = 1.0) -> int | None:
    """Index of the part's first frame whose median parallax against its first one is as large; None without one.

    Corners of the first image are followed by Lucas and Kanade's flow from frame to frame; a corner's parallax is the
    angle between its two rays once the true rotation is taken out.
    """
    fx, fy, cx, cy = part.intrinsics()
    poses = part.true_poses()
    first_px = last_px = previous = None
    for index, frame in enumerate(part.read()):
        if previous is None or first_px is None or last_px is None:
            corners = cv2.goodFeaturesToTrack(frame.image, _CORNERS, 0.01, 7)
            first_px = last_px = np.asarray(corners, np.float32)
        else:
            flown, status, _ = cv2.calcOpticalFlowPyrLK(previous, frame.image, last_px, np.empty_like(last_px))
            kept = status.ravel() == 1
            first_px, last_px = first_px[kept], flown[kept]
            rays = [
                np.column_stack([(px[:, 0, 0] - cx) / fx, (px[:, 0, 1] - cy) / fy, np.ones(len(px))])
                for px in (first_px, last_px)
            ]
            first, last = (ray / np.linalg.norm(ray, axis=1, keepdims=True) for ray in rays)
            last_in_first = last @ (np.linalg.inv(poses[0])[:3, :3] @ poses[index][:3, :3]).T
            angles_deg = np.degrees(np.arccos(np.clip((first * last_in_first).sum(axis=1), -1, 1)))
            if np.median(angles_deg) >= parallax_deg:
                return index
        previous = frame.image
    return None
