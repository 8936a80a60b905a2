# SPDX-License-Identifier: Apache-2.0
"""Whatever is encoded comes back the same; whatever is broken is refused by name."""

import dataclasses
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas import topics
from schemas.codec import decode, encode
from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from schemas.errors import ProtocolError
from schemas.proto.kinemap.objects_pb2 import Objects
from schemas.records import MapUpdate
from schemas.topics import TOPICS, Topic
from tests.unit.schemas.records_strategies import RECORDS


def assert_same(left: Any, right: Any, place: str = "") -> None:
    if isinstance(left, np.ndarray):
        # A rotation goes through a unit quaternion; everything else comes back to the bit.
        tolerance = 1e-9 if "world_from_camera" in place else 0.0
        np.testing.assert_allclose(left, right, rtol=0, atol=tolerance, err_msg=place)
    elif dataclasses.is_dataclass(left):
        for field in dataclasses.fields(left):
            assert_same(getattr(left, field.name), getattr(right, field.name), f"{place}.{field.name}")
    elif isinstance(left, tuple):
        assert len(left) == len(right), place
        for index, (one, other) in enumerate(zip(left, right, strict=True)):
            assert_same(one, other, f"{place}[{index}]")
    else:
        assert left == right, place


def test_every_topic_has_a_strategy_here() -> None:
    assert set(RECORDS) == set(TOPICS)


@pytest.mark.parametrize("topic", TOPICS, ids=str)
@settings(max_examples=30, deadline=None)
@given(data=st.data())
def test_a_record_comes_back_the_same(topic: Topic, data: st.DataObject) -> None:
    record = data.draw(RECORDS[topic])
    payload = encode(topic, record)
    assert payload == encode(topic, record)
    assert_same(record, decode(topic, payload))


@pytest.mark.parametrize("topic", TOPICS, ids=str)
@settings(max_examples=60, deadline=None)
@given(payload=st.binary(max_size=200))
def test_any_bytes_are_a_record_or_a_protocol_error(topic: Topic, payload: bytes) -> None:
    try:
        decode(topic, payload)
    except ProtocolError as error:
        assert str(error).startswith(topic.key)
        assert "\n" not in str(error)


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_a_cut_off_message_is_a_record_or_a_protocol_error(data: st.DataObject) -> None:
    topic = data.draw(st.sampled_from(TOPICS))
    payload = encode(topic, data.draw(RECORDS[topic]))
    cut = data.draw(st.integers(0, len(payload)))
    try:
        decode(topic, payload[:cut])
    except ProtocolError as error:
        assert topic.key in str(error)


def test_another_version_is_refused() -> None:
    payload = Objects(version=7).SerializeToString()
    with pytest.raises(ProtocolError, match=r"tracker/objects: message version 7, expected 1"):
        decode(topics.OBJECTS, payload)


def test_arrays_that_do_not_belong_together_are_refused() -> None:
    update = MapUpdate(0, landmark_id=np.arange(3))
    with pytest.raises(ProtocolError, match=r"landmark_\* arrays"):
        decode(topics.MAP_UPDATE, encode(topics.MAP_UPDATE, update))


def test_a_label_image_that_claims_more_than_it_holds_is_refused() -> None:
    message = Objects(version=1)
    message.track_image.width, message.track_image.height = 1 << 20, 1 << 20
    with pytest.raises(ProtocolError, match="expected at most"):
        decode(topics.OBJECTS, message.SerializeToString())


@given(quaternion=st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 1e-3))
def test_pose_and_matrix_agree(quaternion: list[float]) -> None:
    unit = np.array(quaternion) / np.linalg.norm(quaternion)
    matrix = matrix_from_pose(np.array([1.0, 2.0, 3.0, *unit]))
    np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-12)
    back = pose_from_matrix(matrix)
    np.testing.assert_allclose(matrix_from_pose(back), matrix, atol=1e-12)
    assert back[6] >= 0
