# SPDX-License-Identifier: Apache-2.0
"""The topic table is held against what the services really take and give."""

import ast
import importlib
import inspect
from pathlib import Path

import pytest

from schemas import topics
from services.runtime.service import FrameService

SERVICES = Path(__file__).resolve().parents[3] / "services"
FRAME_SERVICES = ("segmenter", "motion", "tracker", "slam", "mapstore")


def frame_service(name: str) -> type[FrameService]:
    module = importlib.import_module(f"services.{name}.service")
    (service,) = (
        member
        for _, member in inspect.getmembers(module, inspect.isclass)
        if issubclass(member, FrameService) and member.__module__ == module.__name__
    )
    return service


def topics_named_in(name: str) -> set[str]:
    """The topics a service.py names where it makes an Outgoing or publishes."""
    names: set[str] = set()
    for path in (SERVICES / name).glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "topics":
                names.add(node.attr)
    return {getattr(topics, name).key for name in names if isinstance(getattr(topics, name, None), topics.Topic)}


@pytest.mark.parametrize("name", FRAME_SERVICES)
def test_a_service_takes_what_the_table_says(name: str) -> None:
    service = frame_service(name)
    assert service.name == name
    taken = {topic.key for topic in (*service.awaits, *service.final_awaits, topics.MANIFEST, topics.END)}
    listed = {topic.key for topic in topics.TOPICS if name in topic.consumers}
    assert taken == listed


@pytest.mark.parametrize("name", FRAME_SERVICES)
def test_a_service_names_what_the_table_lets_it_give(name: str) -> None:
    given = {topic.key for topic in topics.TOPICS if topic.producer == name}
    taken = {topic.key for topic in topics.TOPICS if name in topic.consumers}
    named = topics_named_in(name)
    assert given <= named, "listed as given, never named in the service"
    assert named - taken - {topics.ANSWER.key, topics.HEARTBEAT.key} <= given, "named, but the table says otherwise"


@pytest.mark.parametrize("name", FRAME_SERVICES)
def test_who_answers_is_who_the_camera_waits_for(name: str) -> None:
    assert frame_service(name).answers == (name in topics.ANSWERING_SERVICES)


def test_the_camera_gives_what_the_table_says() -> None:
    given = {topic.key for topic in topics.TOPICS if topic.producer == "camera"}
    assert given <= topics_named_in("camera")


def test_keys_are_unique_and_one_direction_holds() -> None:
    keys = [topic.key for topic in topics.TOPICS]
    assert len(keys) == len(set(keys))
    order = ["camera", "segmenter", "motion", "tracker", "slam", "mapstore", "recorder", "cli"]
    for topic in topics.TOPICS:
        if topic.producer != "*":
            assert all(order.index(consumer) > order.index(topic.producer) for consumer in topic.consumers), topic.key


def test_a_recorded_topic_goes_to_the_recorder() -> None:
    for topic in topics.TOPICS:
        assert topic.recorded == ("recorder" in topic.consumers), topic.key
