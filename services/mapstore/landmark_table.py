# SPDX-License-Identifier: Apache-2.0
"""Every landmark by id, and which keyframe's cluster or which object's sightings a change concerns."""

from collections import defaultdict

import numpy as np
import numpy.typing as npt

from schemas.records import MapUpdate, MotionState
from services.mapstore.growing_table import GrowingTable
from services.mapstore.landmark_cluster import STATES, LandmarkCluster

Rows = npt.NDArray[np.intp]
NOWHERE = -1
"""The anchor row of a removed landmark."""


class LandmarkTable:
    """Landmark rows with two memberships: the keyframe that anchors it, and the object it is a sighting of as it moves.

    Memberships are appended when they begin and checked when they are read, so that a change costs time in proportion
    to itself, never to the map.
    """

    def __init__(self) -> None:
        self._table = GrowingTable(
            id=np.empty(0, np.int64),
            anchor_row=np.empty(0, np.int64),
            position=np.empty((0, 3), np.float32),
            state=np.empty(0, np.uint8),
            category=np.empty(0, np.int32),
            object_id=np.empty(0, np.uint32),
            first_seen_ns=np.empty(0, np.int64),
            last_seen_ns=np.empty(0, np.int64),
            valid_until_ns=np.empty(0, np.int64),
        )
        self._row_of: dict[int, int] = {}
        self._anchored: defaultdict[int, list[Rows]] = defaultdict(list)
        self._sighted: defaultdict[int, list[Rows]] = defaultdict(list)

    def __len__(self) -> int:
        """Rows ever, removed ones included."""
        return len(self._table)

    def upsert(self, update: MapUpdate, anchor_rows: Rows) -> tuple[set[int], set[int]]:
        """Takes the landmarks of `update`. Returns the keyframe rows and the object ids whose landmarks changed."""
        if len(update.landmark_id) == 0:
            return set(), set()
        rows = self._rows_for(update.landmark_id)
        keyframes, objects = self._memberships(rows)
        old_anchor = self._table["anchor_row"][rows]
        old_sighting = self._sighting_of(rows)
        self._table.write(
            rows,
            {
                "anchor_row": anchor_rows,
                "position": update.landmark_position,
                "state": np.where(update.landmark_state < STATES, update.landmark_state, MotionState.UNDECIDED),
                "category": update.landmark_category,
                "object_id": update.landmark_object_id,
                "first_seen_ns": update.landmark_first_seen_ns,
                "last_seen_ns": update.landmark_last_seen_ns,
                "valid_until_ns": update.landmark_valid_until_ns,
            },
        )
        _begin(self._anchored, rows, old_anchor, self._table["anchor_row"][rows])
        _begin(self._sighted, rows, old_sighting, self._sighting_of(rows))
        new_keyframes, new_objects = self._memberships(rows)
        return keyframes | new_keyframes, objects | new_objects

    def remove(self, landmark_ids: npt.NDArray[np.int64]) -> tuple[set[int], set[int]]:
        """Takes landmarks out; unknown ids are nothing to remove. Returns what `upsert` returns."""
        known = [self._row_of[number] for number in landmark_ids.tolist() if number in self._row_of]
        rows = np.array(known, dtype=np.intp)
        changed = self._memberships(rows)
        self._table.write(rows, {"anchor_row": NOWHERE})
        return changed

    def cluster(self, keyframe_row: int) -> LandmarkCluster:
        """The landmarks anchored in this keyframe now, by id; those without a finite position are left out."""
        rows = self._members(self._anchored, keyframe_row)
        rows = rows[self._table["anchor_row"][rows] == keyframe_row]
        self._anchored[keyframe_row] = [rows]
        rows = rows[np.isfinite(self._table["position"][rows]).all(axis=1)]
        rows = rows[np.argsort(self._table["id"][rows])]
        names = ("id", "position", "state", "category", "object_id", "first_seen_ns", "last_seen_ns", "valid_until_ns")
        return LandmarkCluster(*(self._table[name][rows] for name in names))

    def sightings(self, object_id: int) -> npt.NDArray[np.int64]:
        """When the object's moving landmarks were last seen: times in ns, rising, each once."""
        rows = self._members(self._sighted, object_id)
        rows = rows[self._sighting_of(rows) == object_id]
        self._sighted[object_id] = [rows]
        times: npt.NDArray[np.int64] = np.unique(self._table["last_seen_ns"][rows]).astype(np.int64)
        return times

    def _rows_for(self, landmark_ids: npt.NDArray[np.int64]) -> Rows:
        ids = landmark_ids.tolist()
        new = [number for number in dict.fromkeys(ids) if number not in self._row_of]
        added = self._table.append(len(new), {"id": new, "anchor_row": NOWHERE})
        self._row_of.update(zip(new, added.tolist(), strict=True))
        return np.array([self._row_of[number] for number in ids], dtype=np.intp)

    def _sighting_of(self, rows: Rows) -> npt.NDArray[np.int64]:
        """The object each row is a moving, present landmark of; 0 for none."""
        moving = (self._table["state"][rows] == MotionState.MOVING) & (self._table["anchor_row"][rows] != NOWHERE)
        return np.where(moving, self._table["object_id"][rows], 0).astype(np.int64)

    def _memberships(self, rows: Rows) -> tuple[set[int], set[int]]:
        keyframes = set(np.unique(self._table["anchor_row"][rows]).tolist()) - {NOWHERE}
        return keyframes, set(np.unique(self._sighting_of(rows)).tolist()) - {0}

    @staticmethod
    def _members(lists: defaultdict[int, list[Rows]], key: int) -> Rows:
        parts = lists.get(key, [])
        return np.unique(np.concatenate(parts)) if parts else np.empty(0, np.intp)


def _begin(
    lists: defaultdict[int, list[Rows]], rows: Rows, before: npt.NDArray[np.generic], now: npt.NDArray[np.generic]
) -> None:
    """Enters each row whose group changed into the list of its new group."""
    changed = before != now
    rows, groups = rows[changed], now[changed]
    order = np.argsort(groups, kind="stable")
    values, starts = np.unique(groups[order], return_index=True)
    for value, members in zip(values.tolist(), np.split(rows[order], starts[1:]), strict=False):
        lists[int(value)].append(members)
