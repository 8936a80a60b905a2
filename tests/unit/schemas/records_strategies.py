# SPDX-License-Identifier: Apache-2.0
"""Any record of any topic, for property tests."""

from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from schemas import records as r
from schemas import topics
from schemas.topics import Topic

TIMES = st.integers(0, 2**62)
IDS = st.integers(0, 2**32 - 1)
NUMBERS = st.floats(-1e6, 1e6)
SINGLES = st.floats(-1e6, 1e6, width=32)
WORDS = st.text(max_size=12)
BOXES = st.tuples(SINGLES, SINGLES, SINGLES, SINGLES)
TRIPLES = st.tuples(NUMBERS, NUMBERS, NUMBERS)
SHAPES = hnp.array_shapes(min_dims=2, max_dims=2, max_side=9)


def arrays(dtype: str, shape: Any) -> st.SearchStrategy[Any]:
    elements = st.floats(-1e6, 1e6, width=32 if dtype == "f4" else 64) if dtype.startswith("f") else None
    return hnp.arrays(dtype, shape, elements=elements)


LABELS = arrays("u4", SHAPES)
POSES = arrays("f8", 7).map(lambda pose: np.concatenate((pose[:3], [0.0, 0.6, 0.0, 0.8])))


@st.composite
def rigid_matrices(draw: st.DrawFn) -> Any:
    from schemas.codec.rigid import matrix_from_pose

    quaternion = draw(arrays("f8", 4).filter(lambda q: np.linalg.norm(q) > 1e-3))
    return matrix_from_pose(np.concatenate((draw(arrays("f8", 3)), quaternion)))


@st.composite
def map_updates(draw: st.DrawFn) -> r.MapUpdate:
    from schemas.codec.slam import _ARRAYS

    rows = {prefix: draw(st.integers(0, 5)) for prefix in ("keyframe", "landmark", "frame", "removed")}
    points = draw(st.lists(st.integers(0, 5), max_size=3))
    rows |= {"dense_keyframe": len(points), "dense_point": sum(points)}
    drawn = {}
    for name, (dtype, columns) in _ARRAYS.items():
        (count,) = (number for prefix, number in rows.items() if name.startswith(f"{prefix}_"))
        drawn[name] = draw(arrays(dtype.lstrip("<"), (count, *columns)))
    drawn["dense_keyframe_points"] = np.array(points, np.int32)
    return r.MapUpdate(draw(TIMES), draw(st.integers(0, 9)), draw(st.booleans()), **drawn)


def _calibrations() -> st.SearchStrategy[r.CameraCalibration]:
    distortions = st.one_of(st.just(()), st.tuples(*[st.floats(0.01, 1.0)] * 5))
    sides = st.integers(1, 5000)
    lenses = st.one_of(
        st.tuples(distortions, st.just("plumb_bob")),
        st.tuples(st.tuples(*[st.floats(0.01, 1.0)] * 4), st.just("kannala_brandt")),
    )
    shapes = st.tuples(TIMES, sides, sides, arrays("f8", (3, 3)), arrays("f8", (3, 4)), WORDS)
    return st.builds(lambda shape, lens: r.CameraCalibration(*shape[:4], lens[0], *shape[4:], lens[1]), shapes, lenses)


def _tracked_frames() -> st.SearchStrategy[r.TrackedFrame]:
    return st.builds(
        r.TrackedFrame,
        timestamp_ns=TIMES,
        state=st.sampled_from(r.TrackingState),
        reason=WORDS,
        map_id=st.integers(0, 99),
        map_from_camera=st.none() | POSES,
        covariance=st.none() | arrays("f8", (6, 6)),
        reference_keyframe_id=st.integers(-1, 2**60),
        camera_from_reference=st.none() | POSES,
        features=st.integers(0, 9999),
        tracked_landmarks=st.integers(0, 9999),
        keyframe_inserted=st.booleans(),
        masks=st.sampled_from(r.MaskSource),
        metric_scale=st.booleans(),
        handling=st.sampled_from(["base", "dynamic", "moving"]),
        moving_unplaced=st.integers(0, 999),
        stage_ms=st.dictionaries(WORDS, NUMBERS, max_size=3),
        loop_closed=st.booleans(),
        maps_merged=st.booleans(),
    )


IMAGES = st.builds(r.Image, TIMES, arrays("u1", SHAPES) | arrays("u1", (3, 4, 3)), WORDS)
OBJECT_TRACKS = st.builds(
    r.ObjectTrack, IDS, WORDS, SINGLES, st.sampled_from(r.MotionState), NUMBERS, BOXES, st.integers(0, 9999)
)
MAPPED_OBJECTS = st.builds(
    r.MappedObject,
    IDS,
    WORDS,
    st.sampled_from(r.MotionState),
    TRIPLES,
    TRIPLES,
    NUMBERS,
    TRIPLES,
    NUMBERS,
    NUMBERS,
    st.booleans(),
)
INSTANCES = st.builds(r.Instance, IDS, WORDS, SINGLES, BOXES)
TRUE_OBJECTS = st.builds(r.TrueObject, IDS, WORDS, st.booleans(), TRIPLES, TRIPLES, BOXES, NUMBERS, st.none() | TRIPLES)
INSTANCE_MOTIONS = st.builds(
    r.InstanceMotion,
    IDS,
    WORDS,
    SINGLES,
    BOXES,
    NUMBERS,
    NUMBERS,
    NUMBERS,
    st.integers(0, 9999),
    st.integers(0, 99),
)
RECORDS: dict[Topic, st.SearchStrategy[Any]] = {
    topics.MANIFEST: st.builds(
        r.FrameManifest, TIMES, WORDS, WORDS, st.lists(WORDS, max_size=4).map(tuple), st.integers(-1, 10**9), NUMBERS
    ),
    topics.CALIBRATION: _calibrations(),
    topics.CALIBRATION_RIGHT: _calibrations(),
    topics.MAPPED_OBJECTS: st.builds(
        r.MappedObjects, TIMES, st.integers(0, 99), st.booleans(), st.lists(MAPPED_OBJECTS, max_size=3).map(tuple)
    ),
    topics.IMAGE: IMAGES,
    topics.IMAGE_RIGHT: IMAGES,
    topics.DEPTH: st.builds(r.DepthImage, TIMES, arrays("f4", SHAPES), WORDS),
    topics.TRUE_POSE: st.builds(r.TruePose, TIMES, rigid_matrices()),
    topics.TRUE_INSTANCES: st.builds(r.TrueInstances, TIMES, LABELS, st.lists(TRUE_OBJECTS, max_size=3).map(tuple)),
    topics.END: st.builds(r.EndOfInput, TIMES, st.integers(0, 10**9)),
    topics.INSTANCES: st.builds(r.Instances, TIMES, LABELS, st.lists(INSTANCES, max_size=3).map(tuple), st.booleans()),
    topics.EGO_MOTION: st.builds(
        r.EgoMotion,
        TIMES,
        TIMES,
        st.booleans(),
        WORDS,
        arrays("f8", (3, 3)),
        arrays("f8", 3),
        NUMBERS,
        st.integers(0, 9999),
        NUMBERS,
        NUMBERS,
    ),
    topics.INSTANCE_MOTIONS: st.builds(
        r.InstanceMotions, TIMES, LABELS, st.lists(INSTANCE_MOTIONS, max_size=3).map(tuple)
    ),
    topics.MOVING_MASK: st.builds(r.MovingMask, TIMES, arrays("u1", SHAPES)),
    topics.OBJECTS: st.builds(
        r.Objects, TIMES, LABELS, st.lists(OBJECT_TRACKS, max_size=3).map(tuple), st.integers(0, 99)
    ),
    topics.TRACKED_FRAME: _tracked_frames(),
    topics.MAP_UPDATE: map_updates(),
    topics.POSE: st.builds(r.PoseInMap, TIMES, POSES),
    topics.DENSITY: st.builds(
        r.Density,
        TIMES,
        TRIPLES,
        NUMBERS,
        NUMBERS | st.just(float("inf")),
        st.integers(0, 9999),
        st.integers(0, 9999),
        st.integers(0, 9999),
        st.sampled_from(r.DensityLevel),
        st.booleans(),
    ),
    topics.ANSWER: st.builds(r.FrameAnswer, TIMES, WORDS),
    topics.HEARTBEAT: st.builds(
        r.Heartbeat, WORDS, IDS, WORDS, st.integers(-1, 10**9), IDS, st.dictionaries(WORDS, NUMBERS, max_size=3)
    ),
}
