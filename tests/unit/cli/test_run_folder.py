# SPDX-License-Identifier: Apache-2.0
import os
from datetime import datetime
from pathlib import Path

import pytest

from services.cli.run_folder import CONFIG_NAME, new_run_folder, newest_run_folder, write_config
from services.runtime.config import load_config
from services.runtime.errors import InputError, ResourceError

NOON = datetime(2026, 11, 22, 12, 0, 5)


def test_default_folder_is_named_by_the_time_and_never_one_that_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    first = new_run_folder(None, NOON)
    assert first == tmp_path / "runs" / "20261122-120005"
    first.mkdir(parents=True)
    assert new_run_folder(None, NOON).name == "20261122-120005-2"


def test_an_empty_folder_is_taken(tmp_path: Path) -> None:
    assert new_run_folder(tmp_path) == tmp_path


def test_a_folder_with_anything_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "map.pcd").write_text("precious")
    with pytest.raises(InputError, match="is not empty, expected one that does not exist or is empty"):
        new_run_folder(tmp_path)
    with pytest.raises(InputError, match="is a file, expected a folder"):
        new_run_folder(tmp_path / "map.pcd")
    assert (tmp_path / "map.pcd").read_text() == "precious"


def test_the_written_configuration_is_the_one_that_is_read_back(tmp_path: Path) -> None:
    config = load_config(None, {"run": {"out": tmp_path / "a" / "b"}, "slam": {"seed": 9, "stage": "base"}})
    assert load_config(write_config(config)).model_dump() == config.model_dump()


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    config = load_config(None, {"run": {"out": tmp_path / "file" / "run"}})
    with pytest.raises(ResourceError, match="cannot be written: Not a directory"):
        write_config(config)


def test_the_newest_run_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="no run in"):
        newest_run_folder(None)
    for seconds, name in enumerate(("b", "c", "a")):
        (tmp_path / "runs" / name).mkdir(parents=True)
        (tmp_path / "runs" / name / CONFIG_NAME).write_text("")
        os.utime(tmp_path / "runs" / name / CONFIG_NAME, (1000 + seconds, 1000 + seconds))
    assert newest_run_folder(None) == tmp_path / "runs" / "a"
    assert newest_run_folder(Path("runs/b")) == tmp_path / "runs" / "b"
    with pytest.raises(InputError, match="no run here"):
        newest_run_folder(tmp_path)
