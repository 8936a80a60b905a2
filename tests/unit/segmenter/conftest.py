# SPDX-License-Identifier: Apache-2.0
"""A folder of label images as a user would have it."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from schemas.records import Image


@pytest.fixture
def image() -> Image:
    return Image(123, np.zeros((20, 30), dtype=np.uint8))


@pytest.fixture
def instances(tmp_path: Path) -> Path:
    """Frame 000000: a sure car (1), an unsure car (2), a chair (3), a person (5). Frame 000001: nothing."""
    folder = tmp_path / "instances"
    folder.mkdir()
    labels = np.zeros((20, 30), dtype=np.uint8)
    labels[2:6, 3:10] = 1
    labels[10:12, 0:4] = 2
    labels[15:20, 25:30] = 3
    labels[8, 20] = 5
    labels[9, 21] = 5
    cv2.imwrite(str(folder / "000000.png"), labels)
    cv2.imwrite(str(folder / "000001.png"), np.zeros((20, 30), dtype=np.uint8))
    rows = [
        {"id": 1, "category": "car", "score": 0.9},
        {"id": 2, "category": "car", "score": 0.2},
        {"id": 3, "category": "chair", "score": 0.9},
        {"id": 4, "category": "car", "score": 0.9},
        {"id": 5, "category": "person", "score": 1},
    ]
    (folder / "instances.json").write_text(json.dumps({"000000": rows, "000001": [], "000007": rows}))
    return folder
