# SPDX-License-Identifier: Apache-2.0
"""Objects as the simulator knows them: lasting ids and whether each moves, so that the engine alone is judged."""

import json
from pathlib import Path

import cv2
import numpy as np

from schemas.categories import category_id
from tests.benchmark.slam.frame_objects import FrameObjects, MotionCode


class TrueObjects:
    """Reads the label images and instances.json of a folder made by `kinemap simulate`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._rows = json.loads((folder / "instances.json").read_text())

    def at(self, name: str) -> FrameObjects:
        """The objects of the frame of this name (its image's, without the extension)."""
        labels = cv2.imread(str(self._folder / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        rows = self._rows[name]
        states = [MotionCode.MOVING if row["moving"] else MotionCode.NON_MOVING for row in rows]
        return FrameObjects(
            np.ascontiguousarray(labels, np.uint32),
            np.array([row["id"] for row in rows], np.uint32),
            np.array([category_id(row["category"]) for row in rows], np.int32),
            np.array(states, np.uint8),
        )
