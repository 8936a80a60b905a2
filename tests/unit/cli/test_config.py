# SPDX-License-Identifier: Apache-2.0
import tomllib
from pathlib import Path

import pytest

from services.cli.config import dump_lines
from services.cli.flags import parse_settings, resolve_config
from services.runtime.config import load_config


def test_the_dump_is_a_configuration_file_of_the_same_values(tmp_path: Path) -> None:
    settings = ["slam.stage=base", "camera.rate_hz=5.0", "camera.input='a \"b\" #c'"]
    config = resolve_config(None, settings, {})
    file = tmp_path / "dumped.toml"
    file.write_text("\n".join(dump_lines(config, None, {}, parse_settings(settings))))
    assert load_config(file).model_dump() == config.model_dump()


def test_every_field_is_there_with_its_meaning_and_its_origin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "c.toml"
    file.write_text("[slam]\nfeatures = 1500\nseed = 3\n")
    monkeypatch.setenv("KINEMAP_SLAM__SEED", "4")
    settings = ["slam.stage=base"]
    config = resolve_config(file, settings, {})
    lines = list(dump_lines(config, file, tomllib.loads(file.read_text()), parse_settings(settings)))

    def comment_of(assignment: str) -> str:
        return lines[lines.index(assignment) - 1]

    assert comment_of('stage = "base"').endswith("; from --set")
    assert comment_of("seed = 4").endswith("; from KINEMAP_SLAM__SEED")
    assert comment_of("features = 1500").endswith(f"; from {file}")
    assert comment_of("pyramid_levels = 8") == "# levels of the image pyramid; default"
    assert "# rate_hz =" in lines
    for section in type(config).model_fields:
        assert f"[{section}]" in lines
