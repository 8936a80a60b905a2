# SPDX-License-Identifier: Apache-2.0
"""Instance messages of rectangles that move over an image."""

from dataclasses import dataclass

import numpy as np

from schemas.records import InstanceMotion, InstanceMotions

HEIGHT, WIDTH = 100, 300


@dataclass(frozen=True)
class Box:
    """One rectangle with what motion says of it."""

    x: int
    y: int
    width: int
    height: int
    category: str = "car"
    probability: float = 0.5
    samples: int = 50
    score: float = 0.8
    age_frames: int = 0


def frame(index: int, *boxes: Box, first_id: int = 1) -> InstanceMotions:
    """Instances numbered from `first_id`; a later box hides an earlier one."""
    labels = np.zeros((HEIGHT, WIDTH), np.uint32)
    rows = []
    for instance_id, box in enumerate(boxes, first_id):
        labels[box.y : box.y + box.height, max(0, box.x) : box.x + box.width] = instance_id
        rows.append(
            InstanceMotion(
                instance_id,
                box.category,
                box.score,
                (float(max(0, box.x)), float(box.y), float(min(box.width, box.x + box.width)), float(box.height)),
                box.probability,
                0.1,
                0.2,
                box.samples,
                box.age_frames,
            )
        )
    return InstanceMotions(index * 100_000_000, labels, tuple(rows))
