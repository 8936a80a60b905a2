# SPDX-License-Identifier: Apache-2.0
"""A cache of the test's own, and a small checkpoint as mmdetection would write it."""

from pathlib import Path
from typing import Any

import pytest
import torch

from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "kinemap" / "weights"


@pytest.fixture(scope="session")
def content() -> dict[str, Any]:
    torch.manual_seed(4)
    meta = {"mmdet_version": "2.24.1", "CLASSES": ["person", "car"], "PALETTE": [(1, 2, 3), (4, 5, 6)], "time": "now"}
    return {"meta": meta, "state_dict": SoloV2(VARIANTS["solov2-light_r18"], 2).state_dict()}


@pytest.fixture(scope="session")
def checkpoint(content: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("checkpoint") / "mine.pth"
    torch.save(content, path)
    return path
