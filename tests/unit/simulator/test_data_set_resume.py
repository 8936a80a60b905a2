# SPDX-License-Identifier: Apache-2.0
"""Data sets that are interrupted, asked for again, asked for otherwise, or on a disk that is full."""

import errno
import hashlib
import os
from dataclasses import replace
from pathlib import Path

import pytest

from services.runtime.errors import InputError, ResourceError
from services.simulator.data_sets.data_set import DataSet
from services.simulator.data_sets.frame_writer import FrameWriter
from services.simulator.data_sets.request import DataSetRequest, first_difference, parse_formats
from services.simulator.data_sets.schedule import CHUNK_FRAMES, Schedule
from services.simulator.data_sets.whole_file import write_whole
from services.simulator.drive import Drive
from tests.unit.simulator.data_set_drive import EVERYTHING, TINY, make, tiny_request

pytest.importorskip("pycocotools")


def _bytes(root: Path) -> dict[str, str]:
    files = (path for path in root.rglob("*") if path.is_file())
    return {str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("whole") / "set"
    make(root, tiny_request(seeds=(3, 4)))
    return root


def test_two_processes_give_the_same_bytes_as_one(whole: Path, tmp_path: Path) -> None:
    rendered = make(tmp_path, tiny_request(seeds=(3, 4)), jobs=2)
    assert rendered == [(sequence, index) for sequence in ("00", "01") for index in range(TINY.frames)]
    assert _bytes(tmp_path) == _bytes(whole)


def test_a_killed_one_goes_on_and_gives_the_same_bytes(whole: Path, tmp_path: Path) -> None:
    request = tiny_request(seeds=(3, 4))
    data_set = DataSet(tmp_path, request)
    with data_set.locked():
        data_set.frames_left()
    writer = FrameWriter(tmp_path, "00", Drive(request.drive_of("00")), EVERYTHING)
    for index in (0, 1, 2):
        writer.write(index)
    images = tmp_path / "sequences" / "00" / "image_2"
    (images / ".000003.png.123.part").write_bytes(b"half a file")
    (images / "000001.png").write_bytes(b"cut off")
    (tmp_path / ".progress" / "00" / "000002.json").write_bytes(b'{"index": 2, "obj')
    before = (images / "000000.png").stat().st_mtime_ns
    assert make(tmp_path, request) == [("00", 1), ("00", 2), ("00", 3), *[("01", index) for index in range(4)]]
    assert (images / "000000.png").stat().st_mtime_ns == before
    assert _bytes(tmp_path) == _bytes(whole)


def test_a_complete_one_is_left_as_it_is(whole: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in whole.rglob("*")}
    assert make(whole, tiny_request(seeds=(3, 4))) == []
    assert {path: path.stat().st_mtime_ns for path in whole.rglob("*")} == before


@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ({"drive": replace(TINY, width=128)}, ("simulator.width=96", "128")),
        ({"drive": replace(TINY, noise=2.0, traffic_seed=5)}, ("simulator.traffic_seed=null", "5")),
        ({"seeds": (3, 5)}, ("seeds=3,4,", "is 3,5;")),
        ({"formats": frozenset({"kitti"})}, ("formats=coco,depth,", "is kitti;")),
    ],
)
def test_other_options_are_refused_by_the_first_that_differs(
    whole: Path, changes: dict[str, object], parts: tuple[str, ...]
) -> None:
    with pytest.raises(InputError) as error:
        DataSet(whole, tiny_request(**{"seeds": (3, 4), **changes}))
    text = str(error.value)
    assert "\n" not in text
    for part in (str(whole), *parts, "another --out"):
        assert part in text


def test_threads_are_no_other_option(whole: Path) -> None:
    assert DataSet(whole, tiny_request(seeds=(3, 4), drive=replace(TINY, threads=2, seed=9))).complete


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "holiday.jpg").write_bytes(b"a picture")
    with pytest.raises(InputError, match=r"holds holiday\.jpg and no dataset\.json, expected a new or empty folder"):
        DataSet(tmp_path, tiny_request())
    with pytest.raises(InputError, match="a file, expected a folder"):
        DataSet(tmp_path / "holiday.jpg", tiny_request())
    assert [path.name for path in tmp_path.iterdir()] == ["holiday.jpg"]


@pytest.mark.parametrize("content", ["", "[]", '{"options": 3}', '{"options": {}, "complete": "yes"}'])
def test_a_broken_manifest_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "dataset.json").write_text(content)
    with pytest.raises(InputError, match=r"dataset\.json.*expected the manifest"):
        DataSet(tmp_path, tiny_request())


def test_a_complete_one_with_a_hole_is_refused(tmp_path: Path) -> None:
    request = tiny_request(drive=replace(TINY, frames=1), formats=parse_formats(["kitti"]))
    make(tmp_path, request)
    (tmp_path / "sequences/00/image_2/000000.png").unlink()
    with pytest.raises(InputError, match=r"image_2/000000\.png is missing from the complete data set"):
        DataSet(tmp_path, request)


def test_formats_are_written_as_asked(tmp_path: Path) -> None:
    make(tmp_path, tiny_request(drive=replace(TINY, frames=1), formats=parse_formats(["flow", "tum"])))
    names = set(_bytes(tmp_path))
    images = {"sequences/00/image_2/000000.png", "sequences/00/calib.txt", "sequences/00/times.txt", "poses/00.txt"}
    rest = {"sequences/00/trajectory.tum", "README.txt", "SHA256SUMS", "dataset.json"}
    assert names == images | rest


def test_only_one_writes_at_a_time(tmp_path: Path) -> None:
    with (
        DataSet(tmp_path, tiny_request()).locked(),
        pytest.raises(ResourceError, match="another kinemap simulate is writing there"),
        DataSet(tmp_path, tiny_request()).locked(),
    ):
        pytest.fail("two hold the lock")


def test_a_full_disk_is_one_line_and_leaves_no_half_file(tmp_path: Path) -> None:
    def full(path: Path) -> None:
        path.write_bytes(b"half of it")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(ResourceError) as error:
        write_whole(tmp_path, "images/000000.png", full)
    assert str(error.value) == (
        f"{tmp_path}/images/000000.png: the disk is full; free some space and give the same command again"
    )
    assert list((tmp_path / "images").iterdir()) == []


def test_a_file_that_is_there_outlives_a_failed_one(tmp_path: Path) -> None:
    written = write_whole(tmp_path, "a.txt", lambda path: path.write_text("first"))
    assert (written.name, written.size_bytes) == ("a.txt", 5)

    def fail(path: Path) -> None:
        path.write_text("seco")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_whole(tmp_path, "a.txt", fail)
    assert (tmp_path / "a.txt").read_text() == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_a_killed_process_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # As one that the kernel takes for want of memory: without a word on its pipe.
    monkeypatch.setenv("PYTHONPATH", str(_module_that_kills(tmp_path)))
    with pytest.raises(ResourceError, match=r"a rendering process was killed \(signal 9\).*fewer --jobs"):
        make(tmp_path / "set", tiny_request(), jobs=2)


def _module_that_kills(folder: Path) -> Path:
    """A start-up file by which every child of multiprocessing kills itself."""
    (folder / "python").mkdir()
    (folder / "python" / "sitecustomize.py").write_text(
        "import os, signal, sys\n"
        "if any('multiprocessing.spawn' in word for word in sys.orig_argv):\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    return folder / "python"


def test_workers_stay_with_their_sequence_and_help_at_the_end() -> None:
    schedule = Schedule({"00": range(3 * CHUNK_FRAMES), "01": range(CHUNK_FRAMES + 1), "02": []})
    first, second = schedule.next_for(0), schedule.next_for(1)
    assert first is not None
    assert second is not None
    assert (first.sequence, second.sequence) == ("00", "01")
    assert first.indices == tuple(range(CHUNK_FRAMES))
    rest = [schedule.next_for(1), schedule.next_for(1), schedule.next_for(0)]
    assert [(chunk.sequence, len(chunk.indices)) for chunk in rest if chunk is not None] == [
        ("01", 1),
        ("00", CHUNK_FRAMES),
        ("00", CHUNK_FRAMES),
    ]
    assert schedule.next_for(0) is None


def test_requests_that_make_no_sense() -> None:
    with pytest.raises(InputError, match="seed 3 stands there twice"):
        DataSetRequest(TINY, (3, 4, 3))
    with pytest.raises(InputError, match="0 seeds, expected 1"):
        DataSetRequest(TINY, ())
    with pytest.raises(InputError, match="seed=4294967296: expected 0 to"):
        DataSetRequest(TINY, (2**32,))
    with pytest.raises(InputError, match="format 'coca': expected some of kitti"):
        parse_formats(["coco", "coca"])
    lens = replace(TINY, lens="radial", distortion=(0.1, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="lens='radial': expected 'pinhole'"):
        DataSetRequest(lens, (1,))


def test_first_difference_of_nested_options() -> None:
    assert first_difference({"a": 1, "b": {"c": 2}}, {"a": 1, "b": {"c": 2}}) is None
    assert first_difference({"a": 1, "b": {"c": 2}}, {"a": 1, "b": {"c": 3}}) == ("b.c", 2, 3)
    assert first_difference({"a": 1}, {"a": 1, "new": 5}) == ("new", None, 5)
