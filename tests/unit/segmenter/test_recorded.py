# SPDX-License-Identifier: Apache-2.0
"""Backend `recorded`: what a segmenter said once is said again."""

from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import Image, Instances
from services.recorder.session_writer import SessionWriter
from services.runtime.errors import InputError
from services.runtime.session_file import RecordedMessage
from services.segmenter.backend import FrameContext, InstanceFilter, skipped_frame
from services.segmenter.label_images import LabelImages
from services.segmenter.recorded import RecordedInstances

CHOSEN = InstanceFilter({"car", "person"}, 0.3)


def _message(sequence: int, instances: Instances) -> RecordedMessage:
    payload = encode(topics.INSTANCES, instances)
    return RecordedMessage(topics.INSTANCES.key, sequence, instances.timestamp_ns, payload)


@pytest.fixture
def session(tmp_path: Path, instances: Path, image: Image) -> Path:
    """Frame 0 (at 123 ns) has masks, frame 1 (at 200 ns) was skipped."""
    path = tmp_path / "session.mcap"
    writer = SessionWriter(path, "a-session")
    found = LabelImages(instances, CHOSEN).segment(image, FrameContext("000000"))
    writer.append([_message(0, found)])
    writer.append([_message(1, skipped_frame(Image(200, image.pixels)))])
    writer.finish()
    writer.close()
    return path


def test_recorded_instances_are_found_by_time(session: Path, instances: Path, image: Image) -> None:
    backend = RecordedInstances(session, InstanceFilter({"car", "person"}, 0.9))
    again = backend.segment(image, FrameContext("any"))
    first = LabelImages(instances, CHOSEN).segment(image, FrameContext("000000"))
    assert encode(topics.INSTANCES, again) == encode(topics.INSTANCES, first)
    assert len(again.instances) == 2
    assert backend.segment(Image(200, image.pixels), FrameContext("any")).skipped
    assert backend.missing_frames == 0
    backend.close()


def test_a_frame_that_was_not_recorded_is_skipped_and_counted(session: Path, image: Image) -> None:
    backend = RecordedInstances(session, CHOSEN)
    assert backend.segment(Image(999, image.pixels), FrameContext("any")).skipped
    assert backend.missing_frames == 1
    backend.close()


def test_a_filter_of_today_still_counts(session: Path, image: Image) -> None:
    backend = RecordedInstances(session, InstanceFilter({"person"}, 0.3))
    found = backend.segment(image, FrameContext("any"))
    assert [item.category for item in found.instances] == ["person"]
    assert set(np.unique(found.labels)) == {0, 5}
    backend.close()


def test_instances_of_another_size_and_cut_off_sessions_are_named(session: Path) -> None:
    backend = RecordedInstances(session, CHOSEN)
    with pytest.raises(InputError, match=r"session\.mcap: instances of frame 000000: 30x20 px, expected 8x8"):
        backend.segment(Image(123, np.zeros((8, 8), dtype=np.uint8)), FrameContext("000000"))
    backend.close()
    session.write_bytes(session.read_bytes()[:-40])
    with pytest.raises(InputError, match=r"session\.mcap"):
        RecordedInstances(session, CHOSEN)
