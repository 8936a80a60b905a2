# SPDX-License-Identifier: Apache-2.0
"""The true surface of a recorded session that has depth and ground truth, such as the simulator's."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from schemas import topics
from schemas.codec import decode
from schemas.topics import BY_KEY, Topic
from services.evaluation.map.surface import BackProjection, SurfaceOptions, thinned
from services.formats.point_cloud import LabelledPoints
from services.runtime.errors import InputError
from services.runtime.session_file import SessionFile

_NEEDED: tuple[Topic, ...] = (topics.CALIBRATION, topics.DEPTH, topics.TRUE_POSE, topics.TRUE_INSTANCES)
_CLOUDS_BEFORE_THINNING = 32


def session_surface(
    path: Path,
    options: SurfaceOptions | None = None,
    *,
    recover: bool = False,
    on_frame: Callable[[int, int], None] | None = None,
) -> LabelledPoints:
    """Back-project true depth by true poses: what stands of every few frames, what moves of every frame.

    World frame of the true poses, metres. `on_frame` is told after each frame how many of how many are done. Raises
    InputError where the session is missing, cut off (unless `recover`), or holds no depth or truth, and where nothing
    in it is near enough.
    """
    options = options or SurfaceOptions()
    clouds: list[LabelledPoints] = []
    waiting: dict[int, dict[str, Any]] = {}
    camera: BackProjection | None = None
    done = 0
    with SessionFile(path, recover=recover) as session:
        frames = {topic.key: len(session.index_of(topic.key)) for topic in _NEEDED}
        for key, count in frames.items():
            if count == 0:
                raise InputError(f"{path}: no {key} in it, expected --surface, or a run with true depth and objects")
        for message in session.messages(frames.keys()):
            records = waiting.setdefault(message.sequence, {})
            records[message.key] = decode(BY_KEY[message.key], message.payload)
            if len(records) < len(_NEEDED):
                continue
            del waiting[message.sequence]
            calibration, depth, pose, truth = (records[topic.key] for topic in _NEEDED)
            camera = camera or BackProjection(calibration)
            chosen = (depth.depth_m > 0.0) & (depth.depth_m <= options.farthest_m)
            if done % options.every_frames:
                chosen &= np.isin(truth.labels, [row.instance_id for row in truth.objects if row.moving])
            clouds.append(thinned([camera.points(depth, pose, truth, chosen)], options.voxel_m))
            if len(clouds) >= _CLOUDS_BEFORE_THINNING:
                clouds = [thinned(clouds, options.voxel_m)]
            done += 1
            if on_frame is not None:
                on_frame(done, frames[topics.DEPTH.key])
    surface = thinned(clouds, options.voxel_m)
    if len(surface) == 0:
        raise InputError(f"{path}: nothing within {options.farthest_m:g} m of the camera, expected a surface")
    return surface
