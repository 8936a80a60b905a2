# SPDX-License-Identifier: Apache-2.0
"""Objects from instance masks, for measuring the engine without the tracker service."""

import json
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from schemas.categories import category_id
from tests.benchmark.slam.frame_objects import FrameObjects, MotionCode


class MaskObjects:
    """Reads label images and instances.json and keeps an instance's id from frame to frame by greatest overlap.

    Who moves is not known: every object counts as standing.
    """

    def __init__(self, folder: Path, least_iou: float = 0.3) -> None:
        self._folder = folder
        self._rows = json.loads((folder / "instances.json").read_text())
        self._least_iou = least_iou
        self._previous: npt.NDArray[np.uint32] | None = None
        self._newest_id = 0

    def at(self, name: str) -> FrameObjects:
        """The objects of the frame of this name; ask in the order of the frames."""
        labels = cv2.imread(str(self._folder / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        track_image = np.zeros(labels.shape, np.uint32)
        ids: list[int] = []
        categories: list[int] = []
        for row in self._rows[name]:
            mask = labels == row["id"]
            if not mask.any():
                continue
            number = self._id_by_overlap(mask, ids)
            track_image[mask] = number
            ids.append(number)
            categories.append(category_id(row["category"]))
        self._previous = track_image
        states = np.full(len(ids), MotionCode.NON_MOVING, np.uint8)
        return FrameObjects(track_image, np.array(ids, np.uint32), np.array(categories, np.int32), states)

    def _id_by_overlap(self, mask: npt.NDArray[np.bool_], taken: list[int]) -> int:
        if self._previous is not None:
            candidates, counts = np.unique(self._previous[mask], return_counts=True)
            for candidate, count in sorted(zip(candidates.tolist(), counts.tolist(), strict=True), key=lambda c: -c[1]):
                union = mask.sum() + (self._previous == candidate).sum() - count
                if candidate != 0 and candidate not in taken and count / union >= self._least_iou:
                    return int(candidate)
        self._newest_id += 1
        return self._newest_id
