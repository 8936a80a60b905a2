# SPDX-License-Identifier: Apache-2.0
"""The outbox: what was said survives; what cannot be written is said in one line."""

from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from services.runtime.envelope import Envelope
from services.runtime.errors import ProtocolError, ResourceError
from services.runtime.outbox import Outbox, Sent


def sent(sequence: int) -> Sent:
    messages = ((topics.OBJECTS, bytes([sequence, 0, 255])), (topics.DENSITY, b""))
    return Sent(Envelope("s", sequence, sequence * 7), messages)


def test_a_successor_finds_state_and_messages(tmp_path: Path) -> None:
    outbox = Outbox(3, tmp_path)
    for n in range(5):
        outbox.record(sent(n), {"value": np.array([n, 1.5])})
    successor = Outbox(3, tmp_path)
    assert successor.get(4) is None
    restored = successor.restore("s")
    assert restored is not None
    sequence, state = restored
    assert sequence == 4
    np.testing.assert_array_equal(state["value"], [4, 1.5])
    assert [successor.get(n) for n in range(5)] == [None, None, sent(2), sent(3), sent(4)]


def test_a_kill_while_writing_leaves_the_frame_before(tmp_path: Path) -> None:
    Outbox(3, tmp_path).record(sent(0), {"value": np.array(0)})
    (tmp_path / "state.part").write_bytes(b"half a fi")
    restored = Outbox(3, tmp_path).restore("s")
    assert restored is not None
    assert restored[0] == 0


def test_without_a_folder_only_memory(tmp_path: Path) -> None:
    outbox = Outbox(2, None)
    outbox.record(sent(1), {"value": np.array(0)})
    assert outbox.get(1) == sent(1)
    assert outbox.restore("s") is None
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_takes_nothing_is_one_clear_line(tmp_path: Path) -> None:
    outbox = Outbox(2, tmp_path / "state")
    (tmp_path / "state").rmdir()
    with pytest.raises(ResourceError, match="cannot be written: No such file"):
        outbox.record(sent(1), {"value": np.array(0)})


@pytest.mark.parametrize("data", [b"", b"short", b"\x00" * 16 + b"\xff"])
def test_an_attachment_that_is_no_envelope_is_refused(data: bytes) -> None:
    with pytest.raises(ProtocolError, match="is no envelope"):
        Envelope.from_bytes(data)


def test_an_envelope_comes_back_the_same() -> None:
    envelope = Envelope("rünn-1", 2**40, 2**60)
    assert Envelope.from_bytes(envelope.to_bytes()) == envelope
