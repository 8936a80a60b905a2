# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest
import torch
from typer.testing import CliRunner

from services.cli.app import app
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS


def test_imported_weights_are_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path = tmp_path / "coco.pth"
    torch.save({"state_dict": SoloV2(VARIANTS["solov2-light_r34"], 80).state_dict()}, path)
    runner = CliRunner()
    done = runner.invoke(app, ["weights", "import", str(path)])
    assert done.exit_code == 0, done.output
    assert done.output.strip() == str(tmp_path / "kinemap" / "weights" / "coco.safetensors")
    listed = runner.invoke(app, ["weights", "list"]).output
    assert "solov2_r101_fpn_ms-3x_coco" in listed
    line = next(line for line in listed.splitlines() if line.startswith("coco"))
    assert line.split() == ["coco", "114", "MB", "coco.pth"]
