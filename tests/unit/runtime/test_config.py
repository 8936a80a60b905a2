# SPDX-License-Identifier: Apache-2.0
"""Defaults, then the file, then the environment, then flags; a wrong value is named in one line."""

import tomllib
from pathlib import Path

import pytest
import tomli_w

from services.runtime.config import dump_config, load_config
from services.runtime.errors import InputError


def write(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_each_source_beats_the_one_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert load_config().slam.features == 2000
    file = write(tmp_path / "c.toml", '[slam]\nfeatures = 1000\nseed = 5\nstage = "base"\n')
    assert load_config(file).slam.features == 1000
    monkeypatch.setenv("KINEMAP_SLAM__FEATURES", "1100")
    assert load_config(file).slam.features == 1100
    config = load_config(file, {"slam": {"features": 1200}})
    assert (config.slam.features, config.slam.seed, config.slam.stage) == (1200, 5, "base")


def test_a_dump_loads_to_the_same(tmp_path: Path) -> None:
    config = load_config(None, {"slam": {"stage": "dynamic"}, "run": {"out": str(tmp_path), "session": "x"}})
    file = write(tmp_path / "dump.toml", tomli_w.dumps(dump_config(config)))
    assert dump_config(load_config(file)) == dump_config(config)
    assert tomllib.loads(file.read_text())["slam"]["stage"] == "dynamic"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('[slam]\nstage = "fast"\n', r"slam\.stage = 'fast': input should be 'base', 'dynamic' or 'moving'"),
        ("[delivery]\nwindow = 0\n", r"delivery\.window = 0: .*greater than or equal to 1"),
        ("[slam]\nfeature = 3\n", r"slam\.feature = 3: extra inputs are not permitted"),
        ("[slam\n", "is no TOML"),
    ],
)
def test_a_wrong_value_is_one_clear_line(tmp_path: Path, text: str, expected: str) -> None:
    with pytest.raises(InputError, match=expected) as caught:
        load_config(write(tmp_path / "c.toml", text))
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 2


def test_a_missing_file_is_one_clear_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.toml cannot be read: No such file"):
        load_config(tmp_path / "nowhere.toml")
