# SPDX-License-Identifier: Apache-2.0
"""The camera of a robot's recording: a bag of ROS 1 or 2, or MCAP with ROS 2's or Foxglove's messages."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from schemas.codec.rigid import matrix_from_pose
from schemas.records import CameraCalibration
from services.camera.sources.association import FARTHEST_NS, nearest_pairs
from services.camera.sources.calibration_file import find_calibration, read_calibration
from services.camera.sources.folders.number_rows import ASSUMED_RATE_HZ, rate_of
from services.camera.sources.indexed_source import CameraImages, IndexedSource, Pose
from services.camera.sources.recordings.depth_choice import registered_depth
from services.camera.sources.recordings.frame_tree import FrameTree
from services.camera.sources.recordings.message_calibration import calibration_of
from services.camera.sources.recordings.message_images import LoggedDepths, LoggedImages
from services.camera.sources.recordings.message_log import LoggedMessage, MessageLog
from services.camera.sources.recordings.message_topics import ChosenTopics, TopicOptions, choose_topics
from services.camera.sources.true_path import note_of_missing, poses_at
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


class MessageSource(IndexedSource):
    """The images of one topic, with depth, calibration and truth of others.

    Frames are in the order of their headers' times. Depth that the user named is taken as registered to the images;
    where he named none, the one topic is used whose depth images are of the images' size and frame. An image without
    depth within 0.02 s is left out. The recording is closed with the source, or when it cannot be used.

    Args:
        log: the recording.
        options: the topics that the user named.
        calibration: the user's file, which goes before what the recording tells.
        beside: calibration files to look for where the recording has none.

    Raises:
        InputError: a topic, a calibration or a first message cannot be used; names the recording and the topic.
    """

    def __init__(
        self, log: MessageLog, options: TopicOptions, *, calibration: Path | None = None, beside: Sequence[Path] = ()
    ) -> None:
        self._log = log
        try:
            self._open(log, choose_topics(log, options), (calibration, beside))
        except BaseException:
            log.close()
            raise

    def _open(self, log: MessageLog, topics: ChosenTopics, files: tuple[Path | None, Sequence[Path]]) -> None:
        notes: list[str] = []
        places = _increasing(log, topics.image, notes)
        depth_places: list[LoggedMessage] = []
        depth = topics.depth or registered_depth(log, topics, places, notes)
        if depth is not None:
            places, depth_places = _with_depth(log, topics.image, depth, places, notes)
        images = LoggedImages(log, topics.image, places)
        times_ns = [place.stamp_ns for place in places]
        poses = None
        if topics.truth is not None:
            camera = log.image(topics.image, places[0]).frame_id
            poses = _truth(log, camera, topics.truth, times_ns, notes)
        super().__init__(
            f"{log.name} {topics.image}",
            times_ns,
            rate_of(times_ns, ASSUMED_RATE_HZ),
            CameraImages(images, _calibration(log, topics, images.size, files, notes)),
            depths=None if depth is None else LoggedDepths(log, depth, depth_places, images.size),
            world_from_camera=poses,
            notes=notes,
        )

    def close(self) -> None:
        """Close the recording."""
        self._log.close()


def _increasing(log: MessageLog, topic: str, notes: list[str]) -> list[LoggedMessage]:
    """A topic's messages by time, each time once. Raises InputError when there is none."""
    found = sorted(log.index(topic))
    if not found:
        raise InputError(f"{log.name}: no messages of {topic}, expected at least one")
    if found[0].stamp_ns < 0:
        raise InputError(f"{log.name} {topic}: time {found[0].stamp_ns} ns, expected times from 1970 on")
    kept = [place for before, place in zip([None, *found], found, strict=False)
            if before is None or place.stamp_ns > before.stamp_ns]  # fmt: skip
    if len(kept) < len(found):
        notes.append(f"{len(found) - len(kept)} of {len(found)} messages of {topic} repeat a time and are left out")
    return kept


def _with_depth(
    log: MessageLog, image: str, depth: str, places: list[LoggedMessage], notes: list[str]
) -> tuple[list[LoggedMessage], list[LoggedMessage]]:
    depths = _increasing(log, depth, notes)
    pairs = nearest_pairs([place.stamp_ns for place in places], [place.stamp_ns for place in depths], FARTHEST_NS)
    if not pairs:
        raise InputError(
            f"{log.name}: no image of {image} has one of {depth} within 0.02 s, expected times of one clock"
        )
    if len(pairs) < len(places):
        left_out = len(places) - len(pairs)
        notes.append(f"{left_out} of {len(places)} images have no depth image within 0.02 s and are left out")
    return [places[index] for index, _ in pairs], [depths[other] for _, other in pairs]


def _calibration(
    log: MessageLog,
    topics: ChosenTopics,
    size: tuple[int, int],
    files: tuple[Path | None, Sequence[Path]],
    notes: list[str],
) -> CameraCalibration:
    given, beside = files
    if given is None and topics.info is not None:
        infos = log.index(topics.info)
        if infos:
            return calibration_of(log.info(topics.info, infos[0]), topics, size, log.name, notes)
    model = read_calibration(find_calibration(given, *beside))
    return model.for_images(size, Path(f"{log.name} {topics.image}")).record(0)


def _truth(log: MessageLog, camera: str, truth: str, times_ns: list[int], notes: list[str]) -> list[Pose | None]:
    places = _increasing(log, truth, notes)
    messages = [log.pose(truth, place) for place in places]
    body = messages[0].child_frame_id
    body_from_camera = np.eye(4)
    if body != camera:
        known = FrameTree(log.static_transforms()).transform(body, camera) if body and camera else None
        if known is None:
            what = f"of frame '{body}' " if body else ""
            notes.append(f"{truth}: its poses {what}are taken as the camera's own ('{camera}', optical axis forward)")
        else:
            body_from_camera = known
    try:
        poses = np.array([matrix_from_pose(message.pose) for message in messages]) @ body_from_camera
    except ValueError as error:
        raise InputError(f"{log.name} {truth}: {error}") from error
    path = Trajectory(np.array([place.stamp_ns for place in places], dtype=np.int64), poses, f"{log.name} {truth}")
    found = poses_at(path, times_ns)
    notes += note_of_missing(found)
    return found
