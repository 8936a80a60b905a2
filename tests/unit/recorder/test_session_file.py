# SPDX-License-Identifier: Apache-2.0
"""Reading: by topic and time, and one clear line for whatever is no whole session."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer

from schemas import topics
from schemas.records import Density, Image
from services.recorder.recovery import recover_session
from services.recorder.session_reader import SessionReader
from services.recorder.session_writer import SessionWriter, WriterOptions
from services.runtime.errors import InputError, KinemapError
from services.runtime.session_file import SessionFile
from tests.unit.recorder.recorded_frames import SESSION, recorded_frame, time_of


@pytest.fixture
def session(tmp_path: Path) -> Path:
    path = tmp_path / "session.mcap"
    writer = SessionWriter(path, SESSION, "{}", WriterOptions(reserve_bytes=0))
    for sequence in range(6):
        writer.append(recorded_frame(sequence))
    writer.finish()
    writer.close()
    return path


def test_by_topic_and_time(session: Path) -> None:
    with SessionFile(session) as file:
        some = list(file.messages(["camera/image", "slam/pose"], start_ns=time_of(2), end_ns=time_of(3)))
        assert [(message.key, message.sequence) for message in some] == [
            ("camera/image", 2),
            ("slam/pose", 2),
            ("camera/image", 3),
            ("slam/pose", 3),
        ]
        assert list(file.messages(["camera/depth"])) == []


def test_a_message_is_found_through_the_index(session: Path) -> None:
    with SessionFile(session) as file:
        places = file.index_of("camera/image")
        assert [place.timestamp_ns for place in places] == [time_of(sequence) for sequence in range(6)]
        assert file.at(places[4]) in recorded_frame(4)
        assert file.beside(places[4]) == recorded_frame(4)


def test_records(session: Path) -> None:
    with SessionReader(session) as reader:
        records = list(reader.records([topics.IMAGE, topics.DENSITY], start_ns=time_of(5)))
    assert [type(entry.record) for entry in records] == [Image, Density]
    assert records[1].record.moving_points == 5
    assert records[0].envelope == (SESSION, 5, time_of(5))


def test_what_is_no_session_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "text.mcap").write_text("hello, I am no recording")
    (tmp_path / "empty.mcap").write_bytes(b"")
    for name, said in [("none", "no such file"), ("text", "not an MCAP file"), ("empty", "not an MCAP file")]:
        with pytest.raises(InputError, match=said) as refused:
            SessionFile(tmp_path / f"{name}.mcap")
        assert "\n" not in str(refused.value)
        assert refused.value.exit_code == 2


def test_a_cut_off_session_says_where_and_what_to_do(session: Path) -> None:
    data = session.read_bytes()
    session.write_bytes(data[: len(data) * 6 // 10])
    with pytest.raises(InputError, match=rf"cut off at byte {len(data) * 6 // 10}, inside a .*recovery FILE OUT"):
        SessionFile(session)
    with SessionFile(session, recover=True) as file:
        assert "cut off" in file.recovered
        messages = list(file.messages())
    expected = [message for sequence in range(6) for message in recorded_frame(sequence)]
    assert messages == expected[: len(messages)]
    assert len(messages) >= 2 * len(recorded_frame(0))


def test_a_whole_session_can_be_made_of_a_cut_off_one(session: Path, tmp_path: Path) -> None:
    data = session.read_bytes()
    session.write_bytes(data[: len(data) * 6 // 10])
    done = recover_session(session, tmp_path / "whole.mcap")
    with SessionFile(tmp_path / "whole.mcap") as whole, SessionFile(session, recover=True) as cut:
        assert list(whole.messages()) == list(cut.messages())
        assert whole.session == SESSION
    assert done.messages > 0
    assert done.damaged_chunks == 0
    assert "cut off" in done.why
    with pytest.raises(InputError, match="exists"):
        recover_session(session, tmp_path / "whole.mcap")


def test_a_damaged_chunk_is_named_or_skipped(session: Path) -> None:
    with SessionFile(session) as file:
        chunk = file.index_of("camera/image")[2].chunk
    data = bytearray(session.read_bytes())
    middle = chunk.chunk_start_offset + chunk.chunk_length // 2
    data[middle : middle + 40] = bytes(40)
    session.write_bytes(data)
    with SessionFile(session) as file, pytest.raises(InputError, match=f"chunk at byte {chunk.chunk_start_offset}"):
        list(file.messages())
    with SessionFile(session, recover=True) as file:
        assert [message.sequence for message in file.messages(["camera/image"])] == [0, 1, 3, 4, 5]
        assert file.damaged_chunks == 1


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(position=st.floats(0, 0.999), junk=st.binary(min_size=1, max_size=24), recover=st.booleans())
def test_no_damage_gives_anything_but_whole_messages_or_one_line(
    session: Path, tmp_path: Path, position: float, junk: bytes, recover: bool
) -> None:
    data = bytearray(session.read_bytes())
    start = int(position * len(data))
    data[start : start + len(junk)] = junk[: len(data) - start]
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    whole = {message[1:] for sequence in range(6) for message in recorded_frame(sequence)}
    try:
        with SessionFile(damaged, recover) as file:
            assert whole.issuperset(message[1:] for message in file.messages())
            file.index_of("camera/manifest")
    except KinemapError as error:
        assert "\n" not in str(error)


@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD])
def test_a_recording_of_another_program_can_be_read(tmp_path: Path, compression: CompressionType) -> None:
    path = tmp_path / "foreign.mcap"
    writer = Writer(str(path), chunk_size=100, compression=compression)
    writer.start()
    channel = writer.register_channel("lidar", "json", writer.register_schema("Any", "jsonschema", b"{}"))
    for sequence in range(20):
        writer.add_message(channel, sequence * 10, b'{"range": 1}', sequence * 10, sequence)
    writer.finish()
    with SessionFile(path) as file:
        assert [message.sequence for message in file.messages(["lidar"], start_ns=100)] == list(range(10, 20))
        assert file.session == ""
    path.write_bytes(path.read_bytes()[:-60])
    with SessionFile(path, recover=True) as file:
        assert [message.sequence for message in file.messages(["lidar"])] == list(range(20))
