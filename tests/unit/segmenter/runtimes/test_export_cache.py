# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

from services.segmenter.runtimes import export_cache
from services.segmenter.runtimes.export_cache import cached_bytes, exports_folder


class _Writes:
    """Writes these bytes and counts how often it is asked to."""

    def __init__(self, content: bytes = b"a graph" * 1000) -> None:
        self.content = content
        self.times = 0

    def __call__(self, path: Path) -> None:
        self.times += 1
        path.write_bytes(self.content)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def test_it_is_made_once_for_a_key() -> None:
    first, second = _Writes(), _Writes(b"another")
    assert cached_bytes("a", first) == first.content
    assert cached_bytes("a", second) == first.content
    assert cached_bytes("b", second) == second.content
    assert (first.times, second.times) == (1, 1)
    assert len([*exports_folder().iterdir()]) == 2


@pytest.mark.parametrize("damage", ["cut", "bit", "empty", "text"])
def test_what_is_damaged_is_made_anew(damage: str) -> None:
    write = _Writes()
    cached_bytes("a", write)
    (path,) = exports_folder().iterdir()
    whole = path.read_bytes()
    middle = len(whole) // 2
    flipped = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    path.write_bytes({"cut": whole[:middle], "bit": flipped, "empty": b"", "text": b"no archive"}[damage])
    assert cached_bytes("a", write) == write.content
    assert write.times == 2
    assert cached_bytes("a", write) == write.content
    assert write.times == 2


def test_only_the_last_few_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export_cache, "_KEPT", 2)
    for key in "abc":
        cached_bytes(key, _Writes())
    assert len([*exports_folder().iterdir()]) == 2
    last = _Writes()
    cached_bytes("c", last)
    assert last.times == 0


def test_where_nothing_can_be_kept_it_is_made_each_time(cache: Path) -> None:
    (cache / "kinemap").write_text("a file where the folder would be")
    write = _Writes()
    assert cached_bytes("a", write) == write.content
    assert cached_bytes("a", write) == write.content
    assert write.times == 2


def test_a_failure_leaves_nothing_behind() -> None:
    def fails(path: Path) -> None:
        path.write_bytes(b"half")
        raise RuntimeError("an operator is missing")

    with pytest.raises(RuntimeError, match="an operator is missing"):
        cached_bytes("a", fails)
    assert not exports_folder().exists()
