# SPDX-License-Identifier: Apache-2.0
"""`kinemap train vocabulary`."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from services.cli.app import app
from services.cli.train.simulated_views import SimulatedViews
from services.runtime.errors import InputError
from services.slam import _engine


def test_learns_from_a_folder_of_images(tmp_path: Path) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    for seed in range(4):
        blocks = np.random.default_rng(seed).integers(0, 256, (20, 40), np.uint8)
        cv2.imwrite(str(folder / f"{seed}.png"), np.kron(blocks, np.ones((8, 8), np.uint8)))
    out = tmp_path / "words.kmvocab"
    arguments = ["train", "vocabulary", "--images", str(folder), "--out", str(out), "--depth", "2", "--branching", "5"]
    result = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    assert _engine.Vocabulary.load(str(out)).word_count == 25
    assert "25 words" in result.output


def test_refuses_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a file in a folder that is there"):
        CliRunner().invoke(app, ["train", "vocabulary", "--out", str(tmp_path / "no" / "file")], catch_exceptions=False)


def test_views_differ_in_world_size_and_seed() -> None:
    views = list(SimulatedViews(first_seed=5, drives=2, views=2, worlds=("corridor", "street")))
    assert [view.shape for view in views] == [(375, 1242)] * 2 + [(192, 640)] * 2
    assert all(view.dtype == np.uint8 and view.std() > 10 for view in views)
    assert not np.array_equal(views[0], views[1])
