# SPDX-License-Identifier: Apache-2.0
"""The left and right of features on images whose texture is known."""

from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest

from schemas.records import MotionState
from services.evaluation.thesis.feature_balance import (
    FeatureBalance,
    FrameBalance,
    Halves,
    Kept,
    LabelledImage,
    SeenObject,
    SequenceBalance,
)
from services.evaluation.thesis.feature_table import describe_balance, objects_table, plot_skews, skew_table

PARKED, MOVING = 1, 2


def _texture(seed: int = 1) -> np.ndarray:
    coarse = np.random.default_rng(seed).integers(0, 256, (48, 96), dtype=np.uint8)
    return cv2.resize(coarse, (384, 192), interpolation=cv2.INTER_NEAREST)


def _street(state: MotionState | None = MotionState.NON_MOVING) -> LabelledImage:
    """Parked cars all over the left half, one that moves at the far right."""
    labels = np.zeros((192, 384), dtype=np.uint16)
    labels[40:160, 10:150] = PARKED
    labels[100:140, 340:380] = MOVING
    objects = (SeenObject(PARKED, "car", state), SeenObject(MOVING, "car", MotionState.MOVING))
    return LabelledImage("000000", _texture(), labels, objects)


def test_leaving_parked_cars_out_skews_features_away_from_them() -> None:
    halves = FeatureBalance(features=600).measure(_street()).halves
    skew = {kept: halves[kept].skew for kept in Kept}
    assert halves[Kept.ALL].left + halves[Kept.ALL].right == 600
    assert skew[Kept.ALL] == pytest.approx(0.0, abs=0.06)
    assert skew[Kept.WITHOUT_MOVING] == pytest.approx(skew[Kept.ALL], abs=0.05)
    assert skew[Kept.WITHOUT_DYNAMIC] > skew[Kept.ALL] + 0.15
    assert halves[Kept.WITHOUT_DYNAMIC].right == halves[Kept.WITHOUT_MOVING].right < halves[Kept.ALL].right


def test_an_undecided_object_is_left_out_as_a_moving_one() -> None:
    halves = FeatureBalance(features=600).measure(_street(MotionState.UNDECIDED)).halves
    assert halves[Kept.WITHOUT_MOVING] == halves[Kept.WITHOUT_DYNAMIC]


def test_where_nobody_says_what_moves_there_is_nothing_without_moving_ones() -> None:
    assert Kept.WITHOUT_MOVING not in FeatureBalance(features=600).measure(_street(None)).halves


def test_features_are_spread_over_the_image_and_not_where_it_is_strongest() -> None:
    pixels = _texture()
    pixels[:, :192] = 100 + pixels[:, :192] // 8  # faint on the left
    halves = (
        FeatureBalance(features=300).measure(LabelledImage("0", pixels, np.zeros(pixels.shape, np.uint8), ())).halves
    )
    strongest = cv2.ORB.create(300).detect(pixels, None)
    assert np.mean([point.pt[0] > 192 for point in strongest]) > 0.9
    assert abs(halves[Kept.ALL].skew or 0.0) < 0.25


def test_an_image_without_texture_has_no_skew() -> None:
    flat = np.full((192, 384, 3), 90, dtype=np.uint8)
    frame = FeatureBalance().measure(LabelledImage("0", flat, np.zeros((192, 384), np.uint8), ()))
    assert frame.halves[Kept.ALL] == Halves(0, 0)
    assert SequenceBalance("flat", (frame,)).skews(Kept.ALL).size == 0


def _sequence(*halves: tuple[int, int]) -> SequenceBalance:
    seen = Counter(
        {("car", MotionState.NON_MOVING): 19, ("car", MotionState.MOVING): 1, ("person", MotionState.MOVING): 5}
    )
    frames = [FrameBalance(f"{n}", {kept: Halves(*pair) for kept in Kept}, seen) for n, pair in enumerate(halves)]
    return SequenceBalance("05", tuple(frames), without_masks=3)


def test_the_tables_say_the_share_of_parked_cars_and_the_mean_skew() -> None:
    sequence = _sequence((40, 60), (80, 20))
    assert objects_table([sequence]).rows == (("05", "2", "3", "50", "0", "76.0%", "95.0%"),)
    assert skew_table([sequence]).rows[0] == ("05", "all features", "-0.200", "+0.400", "+0.400", "100")
    described = describe_balance([sequence])["05"]
    assert described["parked_share_cars"] == pytest.approx(0.95)
    assert described["skew"]["all features"]["mean"] == pytest.approx(-0.2)
    assert described["by_frame"]["1"]["without moving objects"] == [80, 20]


def test_one_frame_that_does_not_know_leaves_the_kind_out_of_the_table() -> None:
    unknown = FrameBalance(
        "9", {Kept.ALL: Halves(1, 1), Kept.WITHOUT_DYNAMIC: Halves(1, 1)}, Counter({("car", None): 1})
    )
    sequence = SequenceBalance("03", (*_sequence((40, 60)).frames, unknown))
    assert skew_table([sequence]).rows[2] == ("03", "without moving objects", "-", "-", "-", "-")
    assert objects_table([sequence]).rows[0][4] == "1"


def test_the_histogram_is_the_same_again(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        plot_skews([_sequence((40, 60), (80, 20)), _sequence((0, 0))], tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
