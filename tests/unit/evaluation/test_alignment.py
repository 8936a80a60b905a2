# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.alignment import Alignment, align
from services.runtime.errors import InputError


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**31), scale=st.floats(0.01, 100.0))
def test_a_known_similarity_is_found_again(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(12, 3))
    rotation = Rotation.random(rng=rng).as_matrix()
    translation = rng.normal(scale=50.0, size=3)
    target = scale * source @ rotation.T + translation
    found = align(source, target, Alignment.SIM3)
    assert found.scale == pytest.approx(scale, rel=1e-9)
    np.testing.assert_allclose(found.rotation, rotation, atol=1e-9)
    np.testing.assert_allclose(found.points(source), target, atol=1e-8 * (1 + scale))


def test_a_mirrored_target_is_met_by_a_rotation_and_not_by_a_reflection() -> None:
    source = np.random.default_rng(1).normal(size=(30, 3))
    found = align(source, source * (1.0, 1.0, -1.0), Alignment.SIM3)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(20))
def test_a_flat_drive_is_not_turned_over(seed: int) -> None:
    # The third singular value is 0, and its vectors have either sign: without the guard half of these are mirrored.
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(12, 3)) * (1.0, 1.0, 0.0)
    rotation = Rotation.random(rng=rng).as_matrix()
    found = align(source, 3.0 * source @ rotation.T, Alignment.SIM3)
    np.testing.assert_allclose(found.rotation, rotation, atol=1e-9)
    assert found.scale == pytest.approx(3.0)


def test_a_target_at_one_place_gives_no_scale() -> None:
    source = np.random.default_rng(2).normal(size=(30, 3))
    with pytest.raises(InputError, match="all 30 true positions are at one place: they give no scale"):
        align(source, np.full((30, 3), 7.0), Alignment.SIM3)


def test_se3_keeps_the_scale() -> None:
    source = np.random.default_rng(2).normal(size=(30, 3))
    assert align(source, 3.0 * source, Alignment.SE3).scale == 1.0


@pytest.mark.parametrize("mirror", [(1.0, 1.0, 1.0), (1.0, 1.0, -1.0)])
def test_no_other_similarity_is_nearer(mirror: tuple[float, float, float]) -> None:
    rng = np.random.default_rng(4)
    source = rng.normal(size=(40, 3))
    turned = (source * mirror) @ Rotation.random(rng=rng).as_matrix().T
    target = 2.0 * turned + rng.normal(scale=0.3, size=(40, 3))
    found = align(source, target, Alignment.SIM3)
    least = np.square(found.points(source) - target).sum()
    for _ in range(200):
        turned = Rotation.from_rotvec(rng.normal(scale=0.02, size=3)).as_matrix() @ found.rotation
        scale = found.scale * rng.normal(1.0, 0.02)
        other = scale * source @ turned.T + found.translation + rng.normal(scale=0.02, size=3)
        assert np.square(other - target).sum() >= least


def test_a_straight_line_can_be_aligned() -> None:
    source = np.outer(np.arange(10.0), (0.0, 0.0, 1.0))
    target = np.outer(np.arange(10.0), (2.0, 0.0, 0.0)) + 7.0
    np.testing.assert_allclose(align(source, target, Alignment.SIM3).points(source), target, atol=1e-9)


@pytest.mark.parametrize(("points", "expected"), [(np.eye(3)[:2], "at least 3"), (np.full((9, 3), 1e4), "one place")])
def test_what_cannot_be_aligned_is_one_clear_line(points: np.ndarray, expected: str) -> None:
    with pytest.raises(InputError, match=expected) as raised:
        align(points, points, Alignment.SIM3)
    assert "\n" not in str(raised.value)
