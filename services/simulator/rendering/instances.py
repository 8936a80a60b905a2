# SPDX-License-Identifier: Apache-2.0
"""Everybody who is seen in an image, from its labels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor, ActorState
from services.simulator.frame import SimulatedInstance


def visible_instances(labels: NDArray[np.uint16], near: Sequence[tuple[Actor, ActorState]]) -> list[SimulatedInstance]:
    """Everybody with at least one pixel in the labels (H, W), in order of their ids."""
    extents = _extents(labels)
    found = []
    for actor, state in near:
        if actor.instance_id not in extents:
            continue
        box_px, visible_px = extents[actor.instance_id]
        found.append(
            SimulatedInstance(
                actor.instance_id,
                actor.category,
                state.moving,
                state.velocity_m_s,
                state.centre_m,
                state.heading_rad,
                actor.size_m,
                box_px,
                visible_px,
                float(np.arcsin(np.clip(state.world_from_object[2, 0], -1.0, 1.0))),
            )
        )
    return found


def _extents(labels: NDArray[np.uint16]) -> dict[int, tuple[tuple[int, int, int, int], int]]:
    """Box (x, y, width, height) and number of pixels of each id in the labels."""
    rows, columns = np.nonzero(labels)
    ids = labels[rows, columns]
    order = np.argsort(ids, kind="stable")
    ids, rows, columns = ids[order], rows[order], columns[order]
    first = np.flatnonzero(np.diff(ids, prepend=np.uint16(0)))
    if not len(first):
        return {}
    count = np.diff(first, append=len(ids))
    left, right = np.minimum.reduceat(columns, first), np.maximum.reduceat(columns, first)
    # The pixels of one id are still in order of their rows.
    top, bottom = rows[first], rows[first + count - 1]
    boxes = np.stack([left, top, right - left + 1, bottom - top + 1], axis=1).tolist()
    return {
        int(instance_id): ((x, y, width, height), int(pixels))
        for instance_id, (x, y, width, height), pixels in zip(ids[first], boxes, count, strict=True)
    }
