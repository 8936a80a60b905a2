# SPDX-License-Identifier: Apache-2.0
"""The map in memory: takes the updates of one frame after the other and gives immutable views."""

from collections.abc import Mapping
from dataclasses import fields

import numpy as np
import numpy.typing as npt

from schemas.records import MappedObject, MappedObjects, MapUpdate, TrackedFrame, TrackingState
from services.mapstore import sim3
from services.mapstore.growing_table import GrowingTable
from services.mapstore.landmark_cluster import STATES, LandmarkCluster, empty_cluster
from services.mapstore.landmark_table import LandmarkTable
from services.mapstore.map_view import NOT_YET, FrameColumns, KeyframeColumns, MapView

NO_ROW = -1
"""The reference of a frame that names none."""

_NO_POSE = np.full(7, np.nan)
_KEYFRAME_COLUMNS = tuple(field.name for field in fields(KeyframeColumns))
_FRAME_COLUMNS = tuple(field.name for field in fields(FrameColumns))


class MapState:
    """Landmarks relative to their anchor keyframes; the rest is derived from them, and only where something changed."""

    def __init__(self) -> None:
        self._landmarks = LandmarkTable()
        self._keyframes = GrowingTable(
            id=np.empty(0, np.int64),
            timestamp_ns=np.empty(0, np.int64),
            map_id=np.empty(0, np.int64),
            pose=np.empty((0, 8)),
            culled=np.empty(0, np.uint8),
            parent_id=np.empty(0, np.int64),
            local_centre=np.empty((0, 3)),
            local_radius=np.empty(0),
            local_reach=np.empty(0),
            bound_centre=np.empty((0, 3)),
            bound_radius=np.empty(0),
            camera_reach=np.empty(0),
            counts=np.empty((0, STATES), np.int64),
        )
        self._frames = GrowingTable(
            sequence=np.empty(0, np.int64),
            timestamp_ns=np.empty(0, np.int64),
            state=np.empty(0, np.uint8),
            map_id=np.empty(0, np.int64),
            reference_row=np.empty(0, np.int64),
            camera_from_reference=np.empty((0, 7)),
            live_pose=np.empty((0, 7)),
        )
        self._keyframe_row: dict[int, int] = {}
        self._frame_row: dict[int, int] = {}
        self._clusters: list[LandmarkCluster] = []
        self._cameras: list[npt.NDArray[np.float64]] = []
        self._camera_frames: list[list[int]] = []
        self._sightings: dict[int, npt.NDArray[np.int64]] = {}
        self._changed_clusters: set[int] = set()
        self._changed_cameras: set[int] = set()
        self._moved: set[int] = set()
        self._changed_objects: set[int] = set()
        self._newest: tuple[int, int, TrackingState, str, str] = (NOT_YET, 0, TrackingState.INITIALIZING, "", "")
        self._scale: tuple[int, bool] = (0, False)
        self._dense_points: dict[int, int] = {}
        self._objects: tuple[MappedObject, ...] = ()
        self.session = ""

    def add_frame(self, sequence: int, frame: TrackedFrame) -> None:
        """Takes one frame's pose; sequence numbers rise."""
        relative, live = frame.camera_from_reference, frame.map_from_camera
        named = relative is not None and frame.reference_keyframe_id >= 0
        reference = self._row_of_keyframe(frame.reference_keyframe_id) if named else NO_ROW
        (row,) = self._frames.append(
            1,
            {
                "sequence": sequence,
                "timestamp_ns": frame.timestamp_ns,
                "state": frame.state,
                "map_id": frame.map_id,
                "reference_row": reference,
                "camera_from_reference": _NO_POSE if relative is None else relative,
                "live_pose": _NO_POSE if live is None else live,
            },
        ).tolist()
        self._frame_row[frame.timestamp_ns] = row
        self._refer(row, NO_ROW, reference)
        self._newest = (sequence, frame.timestamp_ns, frame.state, frame.reason, frame.handling)
        self._scale = (frame.map_id, frame.metric_scale)
        self._objects = ()

    def see_objects(self, seen: MappedObjects) -> None:
        """Takes the cuboids of the objects in the frame added last; they are not kept beyond it."""
        self._objects = seen.objects

    def finish(self, sequence: int) -> None:
        """The input ended under this sequence number."""
        self._newest = (sequence, *self._newest[1:])

    def apply(self, update: MapUpdate) -> int:
        """Takes the changes of the map. Returns how many frame poses in it belong to no frame that was taken."""
        rows = self._rows_of_keyframes(update.keyframe_id)
        self._keyframes.write(
            rows,
            {
                "timestamp_ns": update.keyframe_timestamp_ns,
                "map_id": update.keyframe_map_id,
                "pose": update.keyframe_pose,
                "culled": update.keyframe_culled,
                "parent_id": update.keyframe_parent_id,
            },
        )
        self._moved.update(rows.tolist())
        for clusters, objects in (
            self._landmarks.upsert(update, self._rows_of_keyframes(update.landmark_anchor_id)),
            self._landmarks.remove(update.removed_landmark_id),
        ):
            self._changed_clusters |= clusters
            self._changed_objects |= objects
        counts = zip(update.dense_keyframe_id.tolist(), update.dense_keyframe_points.tolist(), strict=True)
        self.count_dense_points(dict(counts))
        return self._correct_frames(update)

    def count_dense_points(self, by_keyframe: Mapping[int, int]) -> None:
        """Takes the size of keyframes' semi-dense maps; their points stay in the file."""
        self._dense_points.update(by_keyframe)

    def view(self) -> MapView:
        """The map now. Costs time in proportion to what changed since the last view and to the number of keyframes."""
        self._refresh()
        sequence, timestamp_ns, state, reason, handling = self._newest
        map_id, metric_scale = self._scale
        return MapView(
            session=self.session,
            sequence=sequence,
            timestamp_ns=timestamp_ns,
            map_id=map_id,
            metric_scale=metric_scale,
            state=state,
            reason=reason,
            handling=handling,
            keyframes=KeyframeColumns(**self._keyframes.snapshot(*_KEYFRAME_COLUMNS)),
            clusters=tuple(self._clusters),
            cameras=tuple(self._cameras),
            frames=FrameColumns(**self._frames.snapshot(*_FRAME_COLUMNS)),
            sightings=self._sightings,
            dense_points=sum(self._dense_points.values()),
            objects=self._objects,
        )

    def _rows_of_keyframes(self, keyframe_ids: npt.NDArray[np.int64]) -> npt.NDArray[np.intp]:
        values, inverse = np.unique(keyframe_ids, return_inverse=True)
        rows = np.array([self._row_of_keyframe(number) for number in values.tolist()], dtype=np.intp)
        return rows[inverse]

    def _row_of_keyframe(self, keyframe_id: int) -> int:
        row = self._keyframe_row.get(keyframe_id)
        if row is None:
            unknown = {"id": keyframe_id, "pose": np.nan, "parent_id": -1, "local_radius": -1.0, "local_reach": -1.0}
            (row,) = self._keyframes.append(1, unknown).tolist()
            self._keyframe_row[keyframe_id] = row
            self._clusters.append(empty_cluster())
            self._cameras.append(np.empty((0, 3)))
            self._camera_frames.append([])
            self._moved.add(row)
        return row

    def _correct_frames(self, update: MapUpdate) -> int:
        unknown = 0
        for timestamp_ns, keyframe_id, pose in zip(
            update.frame_timestamp_ns.tolist(),
            update.frame_reference_keyframe_id.tolist(),
            update.frame_camera_from_reference,
            strict=True,
        ):
            row = self._frame_row.get(timestamp_ns)
            if row is None:
                unknown += 1
                continue
            before, reference = int(self._frames["reference_row"][row]), self._row_of_keyframe(keyframe_id)
            at = np.array([row])
            self._frames.write(at, {"reference_row": reference, "camera_from_reference": pose, "map_id": update.map_id})
            self._refer(row, before, reference)
        return unknown

    def _refer(self, frame_row: int, before: int, now: int) -> None:
        for reference in {before, now} - {NO_ROW}:
            self._changed_cameras.add(reference)
        if now not in (NO_ROW, before):
            self._camera_frames[now].append(frame_row)

    def _refresh(self) -> None:
        for row in self._changed_clusters:
            cluster = self._landmarks.cluster(row)
            self._clusters[row] = cluster
            centre, radius = cluster.bound()
            derived: dict[str, npt.ArrayLike] = {
                "local_centre": centre,
                "local_radius": radius,
                "counts": cluster.counts_by_state(),
            }
            self._keyframes.write(np.array([row]), derived)
        for row in self._changed_cameras:
            self._refresh_cameras(row)
        moved = self._moved | self._changed_clusters | self._changed_cameras
        self._place_bounds(np.array(sorted(moved), dtype=np.intp))
        if self._changed_objects:
            seen = {number: self._landmarks.sightings(number) for number in sorted(self._changed_objects)}
            self._sightings = {**self._sightings, **seen}
        for changes in (self._changed_clusters, self._changed_cameras, self._moved, self._changed_objects):
            changes.clear()

    def _refresh_cameras(self, row: int) -> None:
        frames = np.unique(np.array(self._camera_frames[row], dtype=np.intp))
        frames = frames[self._frames["reference_row"][frames] == row]
        poses = self._frames["camera_from_reference"][frames]
        centres = sim3.inverse_pose(poses)[:, :3]
        self._cameras[row] = centres = centres[np.isfinite(centres).all(axis=1)]
        reach = float(np.max(np.linalg.norm(centres, axis=1), initial=-1.0))
        self._keyframes.write(np.array([row]), {"local_reach": reach})

    def _place_bounds(self, rows: npt.NDArray[np.intp]) -> None:
        if len(rows) == 0:
            return
        poses = self._keyframes["pose"][rows]
        placed = {"bound_centre": sim3.transform(poses, self._keyframes["local_centre"][rows])}
        for local, in_map in (("local_radius", "bound_radius"), ("local_reach", "camera_reach")):
            length = self._keyframes[local][rows]
            placed[in_map] = np.where(length < 0, -1.0, length * poses[:, 7])
        self._keyframes.write(rows, placed)
