# SPDX-License-Identifier: Apache-2.0
"""The file survives whatever happens to its writer, and others can read it."""

import errno
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import SeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

from services.recorder.session_writer import SessionWriter, WriterOptions
from services.runtime.errors import InputError, ResourceError
from services.runtime.session_file import RecordedMessage, SessionFile
from tests.unit.recorder.recorded_frames import SESSION, recorded_frame

OPTIONS = WriterOptions(reserve_bytes=4096)


def write(path: Path, frames: range, *, finish: bool = True) -> None:
    writer = SessionWriter(path, SESSION, '{"slam": {"stage": "moving"}}', OPTIONS)
    for sequence in frames:
        writer.append(recorded_frame(sequence))
    if finish:
        writer.finish()
    writer.close()


def read(path: Path, *, recover: bool = False) -> list[RecordedMessage]:
    with SessionFile(path, recover) as file:
        return list(file.messages())


def expected(frames: range) -> list[RecordedMessage]:
    return [message for sequence in frames for message in recorded_frame(sequence)]


def test_a_session_comes_back_as_it_was_written(tmp_path: Path) -> None:
    write(tmp_path / "session.mcap", range(5))
    assert read(tmp_path / "session.mcap") == expected(range(5))
    with SessionFile(tmp_path / "session.mcap") as file:
        assert file.session == SESSION
        assert file.config == {"slam": {"stage": "moving"}}
        assert file.message_counts()["camera/image"] == 5


def test_the_reference_reader_takes_it_checks_it_and_decodes_it_by_the_schemas_in_the_file(tmp_path: Path) -> None:
    write(tmp_path / "session.mcap", range(3))
    with (tmp_path / "session.mcap").open("rb") as stream:
        decoded = list(
            SeekingReader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()]).iter_decoded_messages()
        )
        stream.seek(0)
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(decoded) == len(expected(range(3)))
    assert len(summary.chunk_indexes) == summary.statistics.chunk_count == 3
    images = [entry for entry in decoded if entry.channel.topic == "camera/image"]
    assert {entry.schema.name for entry in images if entry.schema} == {"foxglove.RawImage"}
    assert [(entry.message.sequence, entry.decoded_message.width) for entry in images] == [(0, 8), (1, 8), (2, 8)]
    assert all(entry.message.log_time == entry.message.publish_time for entry in decoded)
    densities = [entry.decoded_message.moving_points for entry in decoded if entry.channel.topic == "mapstore/density"]
    assert densities == [0, 1, 2]
    with (tmp_path / "session.mcap").open("rb") as stream:
        assert sum(1 for _ in StreamReader(stream, validate_crcs=True).records) > len(decoded)


def test_the_same_messages_give_the_same_bytes(tmp_path: Path) -> None:
    write(tmp_path / "one.mcap", range(4))
    write(tmp_path / "two.mcap", range(4))
    assert (tmp_path / "one.mcap").read_bytes() == (tmp_path / "two.mcap").read_bytes()


def test_a_killed_writer_goes_on_and_leaves_the_bytes_of_one_that_was_not(tmp_path: Path) -> None:
    write(tmp_path / "whole.mcap", range(6))
    write(tmp_path / "killed.mcap", range(4), finish=False)
    writer = SessionWriter(tmp_path / "killed.mcap", SESSION, "{}", OPTIONS)
    assert max(sequence for _, sequence in writer.recovered) == 3
    for sequence in (4, 5):
        writer.append(recorded_frame(sequence))
    writer.finish()
    writer.close()
    assert (tmp_path / "killed.mcap").read_bytes() == (tmp_path / "whole.mcap").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["killed.mcap", "whole.mcap"]


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_cut_off_anywhere_it_keeps_every_whole_frame_and_goes_on(tmp_path: Path, data: st.DataObject) -> None:
    path = tmp_path / "session.mcap"
    path.unlink(missing_ok=True)
    ends = [0]
    writer = SessionWriter(path, SESSION, "{}", OPTIONS)
    for sequence in range(4):
        writer.append(recorded_frame(sequence))
        ends.append(writer.size)
    writer.finish()
    writer.close()
    whole = path.read_bytes()
    cut = data.draw(st.integers(0, len(whole) - 1))
    os.truncate(path, cut)
    kept = sum(end <= cut for end in ends[1:])

    if cut >= 8:
        with pytest.raises(InputError, match=f"cut off at byte {cut}"):
            SessionFile(path)
        recovered = read(path, recover=True)
        assert recovered == expected(range(4))[: len(recovered)]
        assert len(recovered) >= len(expected(range(kept)))
    writer = SessionWriter(path, SESSION, "{}", OPTIONS)
    assert {sequence for _, sequence in writer.recovered} == set(range(kept))
    for sequence in range(kept, 4):
        writer.append(recorded_frame(sequence))
    writer.finish()
    writer.close()
    assert read(path) == expected(range(4))
    assert path.read_bytes() == whole


def test_a_finished_session_can_go_on(tmp_path: Path) -> None:
    path = tmp_path / "session.mcap"
    write(path, range(2))
    write(path, range(2, 4))
    assert read(path) == expected(range(4))


def test_another_session_in_the_same_place_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "session.mcap"
    write(path, range(2))
    before = path.read_bytes()
    with pytest.raises(InputError, match="holds the session 'a-session', not 'another'"):
        SessionWriter(path, "another", "{}", OPTIONS)
    path.with_name("notes.mcap").write_text("not a recording at all")
    with pytest.raises(InputError, match="no recorded session"):
        SessionWriter(path.with_name("notes.mcap"), SESSION, "{}", OPTIONS)
    assert path.read_bytes() == before
    assert path.with_name("notes.mcap").read_text() == "not a recording at all"


def test_a_full_disk_ends_it_with_one_line_and_a_whole_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "session.mcap"
    writer = SessionWriter(path, SESSION, "{}", OPTIONS)
    writer.append(recorded_frame(0))
    real = os.pwrite
    reserve = path.with_name(".session.mcap.reserve")
    assert reserve.stat().st_blocks * 512 >= OPTIONS.reserve_bytes

    def full_after_half(file: int, data: memoryview, offset: int) -> int:
        if reserve.exists():
            if offset > writer.size:
                raise OSError(errno.ENOSPC, "No space left on device")
            return real(file, data[: len(data) // 2], offset)
        return real(file, data, offset)

    monkeypatch.setattr(os, "pwrite", full_after_half)
    with pytest.raises(ResourceError, match="No space left on device; the recording ends here, whole and readable"):
        writer.append(recorded_frame(1))
    with pytest.raises(ResourceError, match="the recording ends here"):
        writer.append(recorded_frame(2))
    writer.close()
    assert read(path) == expected(range(1))
    assert not reserve.exists()


def test_a_real_full_disk(tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    if os.system(f"mount -t tmpfs -o size=256k tmpfs {disk} 2>/dev/null") != 0:
        pytest.skip("mounting a small disk needs rights that this user does not have")
    try:
        writer = SessionWriter(disk / "session.mcap", SESSION, "{}", WriterOptions(0, 64 << 10))
        noise = os.urandom(20_000)

        def fill() -> None:
            for sequence in range(100):
                writer.append([RecordedMessage("camera/image", sequence, sequence, noise)])

        with pytest.raises(ResourceError, match="No space left on device; the recording ends here") as stopped:
            fill()
        writer.close()
        assert "\n" not in str(stopped.value)
        sequences = [message.sequence for message in read(disk / "session.mcap")]
        assert sequences == list(range(len(sequences)))
        assert len(sequences) >= 7
    finally:
        os.system(f"umount {disk}")


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ResourceError, match="cannot be written"):
        SessionWriter(tmp_path / "file" / "session.mcap", SESSION)
