# SPDX-License-Identifier: Apache-2.0
import hashlib
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from typer.testing import CliRunner

from services.cli.app import app
from services.motion.flow.public_weights import PUBLIC_WEIGHTS
from services.runtime.errors import InputError
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


def test_weights_for_flow_are_listed_and_imported_only_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    runner = CliRunner()
    listed = runner.invoke(app, ["weights", "list"]).output
    assert any(line.startswith("raft_small ") and "torchvision" in line for line in listed.splitlines())
    path = tmp_path / "raft_small_C_T_V2-01064c6d.pth"
    path.write_bytes(b"not the published one")
    with pytest.raises(InputError, match=r"01064c6d\.pth: its SHA-256 begins with [0-9a-f]{8}, expected 01064c6d"):
        runner.invoke(app, ["weights", "import", str(path)], catch_exceptions=False)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    here = replace(PUBLIC_WEIGHTS[0], file_name=f"raft_small-{digest[:8]}.pth").take(path)
    assert here == tmp_path / "kinemap" / "weights" / "raft_small.pth"
    assert here.read_bytes() == path.read_bytes()
