# SPDX-License-Identifier: Apache-2.0
"""Where an instance touches the ground, and so how far away it is if it stands there."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class GroundContact:
    """The lower edge of an instance, column by column."""

    first_column_px: int
    row_px: npt.NDArray[np.float64]
    """(columns,): the lower convex hull of the mask, on which wheels and feet stand"""
    hidden: bool
    """the true lower edge lies lower: another instance or the image's border cuts it off"""

    def rows_at(self, columns_px: npt.NDArray[np.integer]) -> npt.NDArray[np.float64]:
        """Rows of the contact at image columns (N,)."""
        return np.asarray(self.row_px[np.clip(columns_px - self.first_column_px, 0, len(self.row_px) - 1)])


def find_contact(
    labels: npt.NDArray[np.uint32], instance_id: int, box_px: tuple[int, int, int, int], margin: float = 0.12
) -> GroundContact | None:
    """The contact of the instance inside `box_px` (x, y, width, height) of the label image; None for an empty mask.

    A share `margin` of the columns at either side is left out: there the hull climbs the object's side.
    """
    x, y, width, height = box_px
    mask = labels[y : y + height, x : x + width] == instance_id
    columns = np.flatnonzero(mask.any(axis=0))
    if len(columns) < 3:
        return None
    lowest = height - 1 - np.argmax(mask[::-1, columns], axis=0)
    outline = np.column_stack((columns, lowest)).astype(np.int32)
    closed = np.concatenate((outline, [[columns[-1], -1], [columns[0], -1]])).astype(np.int32)
    hull = cv2.convexHull(closed)[:, 0]
    hull = hull[hull[:, 1] >= 0]
    hull = hull[np.argsort(hull[:, 0], kind="stable")]
    first = int(columns[0] + margin * (columns[-1] - columns[0]))
    last = max(first + 1, int(np.ceil(columns[-1] - margin * (columns[-1] - columns[0]))))
    rows = np.interp(np.arange(first, last + 1), hull[:, 0], hull[:, 1]) + y
    return GroundContact(x + first, rows, _is_hidden(labels, instance_id, x + first, rows))


def _is_hidden(
    labels: npt.NDArray[np.uint32], instance_id: int, first_column: int, rows: npt.NDArray[np.float64]
) -> bool:
    height, width = labels.shape
    columns = np.clip(np.arange(len(rows)) + first_column, 0, width - 1)
    cut = np.zeros(len(rows), dtype=bool)
    for step in (2, 4, 6):
        below = np.rint(rows).astype(int) + step
        outside = below >= height
        label = labels[np.minimum(below, height - 1), columns]
        cut |= outside | ((label != 0) & (label != instance_id))
    return bool(np.mean(cut) > 0.25)
