# SPDX-License-Identifier: Apache-2.0
"""The sheet of frames shows each object in the colour of its state, and nothing else coloured."""

from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from schemas.records import Image, MotionState, Objects, ObjectTrack
from services.evaluation.run.frame_sheet import SeenFrame, plot_frames, tinted
from services.evaluation.run.plots import STATE_COLOURS


def seen(*, colour: bool = False) -> SeenFrame:
    labels = np.zeros((40, 60), dtype=np.uint32)
    labels[10:30, 10:30] = 4
    labels[10:30, 40:55] = 9
    rows = (
        ObjectTrack(4, "car", 1.0, MotionState.MOVING, 0.9, (10, 10, 20, 20), 3),
        ObjectTrack(9, "car", 1.0, MotionState.NON_MOVING, 0.1, (40, 10, 15, 20), 3),
    )
    pixels = np.full((40, 60, 3) if colour else (40, 60), 128, dtype=np.uint8)
    return SeenFrame(7, Image(0, pixels), Objects(0, labels, rows))


def test_objects_are_tinted_by_state_and_background_stays() -> None:
    for colour in (False, True):
        picture = tinted(seen(colour=colour))
        grey = np.full(3, 128 / 255)
        np.testing.assert_allclose(picture[2, 2], grey)
        moving = np.array(to_rgb(STATE_COLOURS[MotionState.MOVING]))
        np.testing.assert_allclose(picture[20, 20], 0.55 * grey + 0.45 * moving)
        standing = np.array(to_rgb(STATE_COLOURS[MotionState.NON_MOVING]))
        np.testing.assert_allclose(picture[20, 48], 0.55 * grey + 0.45 * standing)


def test_a_picture_is_written_only_of_something(tmp_path: Path) -> None:
    plot_frames([], tmp_path / "none.png")
    assert not (tmp_path / "none.png").exists()
    plot_frames([seen(), seen(colour=True), seen()], tmp_path / "three.png")
    assert imread(tmp_path / "three.png").shape[2] == 4
