# SPDX-License-Identifier: Apache-2.0
"""Masks of a frame that was not segmented: those of the frame before, carried by the flow."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import Instance


@dataclass(frozen=True)
class CarriedMasks:
    """Masks in one image: `labels` uint32 (H, W); `age_frames` frames ago they were segmented."""

    labels: npt.NDArray[np.uint32]
    instances: tuple[Instance, ...]
    age_frames: int


def carry_masks(before: CarriedMasks, flow: npt.NDArray[np.float32], least_area_px: int = 30) -> CarriedMasks:
    """The masks `before` as they lie in the current image; `flow` (H, W, 2) px leads from it back to theirs.

    A pixel whose flow leads out of the image is background. What has shrunk below `least_area_px` is gone.
    """
    height, width = before.labels.shape
    columns, rows = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    # remap knows no uint32; float32 holds every label below 2**24 exactly and nearest neighbours never mix two
    moved = cv2.remap(
        before.labels.astype(np.float32), columns + flow[..., 0], rows + flow[..., 1], cv2.INTER_NEAREST
    ).astype(np.uint32)
    kept = []
    for instance in before.instances:
        mask = moved == instance.instance_id
        if int(np.count_nonzero(mask)) < least_area_px:
            moved[mask] = 0
            continue
        kept.append(Instance(instance.instance_id, instance.category, instance.score, bounding_box(mask)))
    return CarriedMasks(moved, tuple(kept), before.age_frames + 1)


def bounding_box(mask: npt.NDArray[np.bool_]) -> tuple[float, float, float, float]:
    """x, y, width, height in px of the true pixels of a mask (H, W) that has some."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    return (
        float(columns[0]),
        float(rows[0]),
        float(columns[-1] - columns[0] + 1),
        float(rows[-1] - rows[0] + 1),
    )
