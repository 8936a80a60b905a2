# SPDX-License-Identifier: Apache-2.0
"""What shutter and sensor do to the image, and that the truth stays what it is."""

from typing import Any

import cv2
import numpy as np
import pytest

from services.runtime.errors import InputError
from services.simulator.camera.linear_light import image_of, light_of
from services.simulator.camera.motion_blur import MotionBlur
from services.simulator.camera.noise import SensorNoise
from services.simulator.camera.timeline import Timeline
from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from services.simulator.worlds.build import build_world
from services.simulator.worlds.world import World

BUILT: dict[int, World] = {}


@pytest.fixture(autouse=True)
def world_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing here changes who stands or moves in the street, only how long it is."""

    def build(options: DriveOptions) -> World:
        key = round(options.drive_length_m)
        if key not in BUILT:
            BUILT[key] = build_world(options)
        return BUILT[key]

    monkeypatch.setattr("services.simulator.drive.build_world", build)


def drive(**options: Any) -> Drive:
    return Drive(DriveOptions(width=160, height=64, **options))


@pytest.fixture
def plain() -> Drive:
    return drive()


def grey(image: np.ndarray) -> np.ndarray:
    return cv2.cvtColor(image.astype(np.float32), cv2.COLOR_BGR2GRAY)


@pytest.mark.parametrize(
    "options",
    [
        {"motion_blur": 0.5},
        {"exposure_wobble": 1.0},
        {"noise": 4.0},
        {"pixel_rain": 0.02},
        {"blackout_start": 119, "blackout_frames": 3},
        {"stereo_baseline_m": 0.4},
    ],
    ids=str,
)
def test_faults_change_the_image_and_never_the_truth(plain: Drive, options: dict[str, Any]) -> None:
    faulty, expected = drive(**options), plain.render(120)
    found = faulty.render(120)
    if "stereo_baseline_m" in options:
        assert np.array_equal(found.image, expected.image)
        assert found.image_right is not None
        assert not np.array_equal(found.image_right, expected.image)
    else:
        assert not np.array_equal(found.image, expected.image)
        assert np.array_equal(found.image, drive(**options).render(120).image)
    assert np.array_equal(found.depth_m, expected.depth_m)
    assert np.array_equal(found.labels, expected.labels)
    assert np.array_equal(found.world_from_camera, expected.world_from_camera)
    assert np.array_equal(faulty.flow(120).flow_px, plain.flow(120).flow_px)


def test_light_and_grey_levels_are_inverse() -> None:
    levels = np.arange(256, dtype=np.uint8)
    assert np.array_equal(image_of(light_of(levels)), levels)


def test_noise_has_its_deviation_at_medium_grey_and_less_in_the_dark() -> None:
    rng = np.random.default_rng(0)
    light = light_of(np.full((200, 200), 128, np.uint8))
    medium = image_of(SensorNoise(5.0).added(light, rng)).astype(float)
    assert medium.std() == pytest.approx(5.0, rel=0.05)
    assert medium.mean() == pytest.approx(128.0, abs=0.3)
    dark = SensorNoise(5.0).added(light_of(np.full((200, 200), 20, np.uint8)), rng)
    assert dark.std() < 0.4 * SensorNoise(5.0).added(light, rng).std()


def test_noise_and_rain_differ_from_frame_to_frame_and_eye_to_eye() -> None:
    noisy = drive(noise=4.0, pixel_rain=0.05, stereo_baseline_m=1e-9)
    first, second = noisy.render(0), noisy.render(1)
    assert first.image_right is not None
    black = [(image == 0).all(axis=-1) for image in (first.image, second.image, first.image_right)]
    assert all(0.01 < one.mean() < 0.08 for one in black)
    assert (black[0] & black[1]).sum() < 0.5 * black[0].sum()
    assert (black[0] & black[2]).sum() < 0.5 * black[0].sum()


def test_rain_hits_its_share_of_pixels(plain: Drive) -> None:
    changed = (drive(pixel_rain=0.1).render(50).image != plain.render(50).image).any(axis=-1)
    assert changed.mean() == pytest.approx(0.1, abs=0.01)


def test_exposure_swings_smoothly_within_its_stops(plain: Drive) -> None:
    swinging = drive(exposure_wobble=1.0)
    ratio = []
    for index in range(0, 60, 4):
        seen, true = light_of(swinging.render(index).image), light_of(plain.render(index).image)
        usable = (true > 0.05) & (true < 0.45)
        ratio.append(np.log2(np.median(seen[usable] / true[usable])))
    assert np.abs(ratio).max() <= 1.02
    assert np.ptp(ratio) > 0.4
    assert np.abs(np.diff(ratio)).max() < 0.5


def test_blur_spreads_a_point_along_its_motion_and_keeps_the_light() -> None:
    light = np.zeros((21, 41, 3), np.float32)
    light[10, 20] = 1.0
    flow = np.zeros((21, 41, 2), np.float32)
    flow[..., 0] = 16.0
    spread = MotionBlur(0.5).spread(light, flow)
    assert spread.sum() == pytest.approx(3.0, rel=1e-4)
    assert spread[10, 17:24].min() > 0.05
    assert spread[10, 20 + 6 :].max() == spread[10, : 20 - 5].max() == 0.0
    assert (np.arange(41) @ spread[10, :, 0]) == pytest.approx(20.0, abs=1e-3)
    assert spread[9].max() == 0.0


def test_blur_is_the_mean_of_what_an_open_shutter_sees() -> None:
    """Against many sharp frames of a much faster camera."""
    size = {"width": 480, "height": 144}
    fast = Drive(DriveOptions(rate_hz=400.0, frames=2100, **size))
    seen = image_of(np.mean([light_of(fast.render(index).image) for index in range(1990, 2011, 2)], axis=0))
    slow = Drive(DriveOptions(motion_blur=0.5, **size))
    assert slow.timestamp_ns(50) == fast.timestamp_ns(2000)
    moving = np.linalg.norm(slow.flow(50).flow_px, axis=-1) > 8.0
    assert moving.mean() > 0.1
    error, unblurred = (
        np.abs(grey(image) - grey(seen))[moving].mean() for image in (slow.render(50).image, fast.render(2000).image)
    )
    assert error < 0.5 * unblurred


def test_black_frames_are_dark_and_not_dead() -> None:
    dark = drive(blackout_start=20, blackout_frames=2)
    before, black, other, after = (dark.render(index).image for index in (19, 20, 21, 22))
    assert before.mean() > 60
    assert after.mean() > 60
    assert black.max() < 60
    assert 0.0 < black.mean() < 8.0
    assert not np.array_equal(black, other)


def test_frozen_frames_show_the_one_before_once_more(plain: Drive) -> None:
    frozen = drive(frozen_frames=0.4)
    shown = [frozen.render(index).image for index in range(30)]
    again = [index for index in range(1, 30) if np.array_equal(shown[index], shown[index - 1])]
    assert 5 <= len(again) <= 20
    assert all(np.array_equal(shown[i], plain.render(i).image) for i in range(30) if i not in again)
    assert np.array_equal(frozen.render(again[0]).depth_m, plain.render(again[0]).depth_m)
    assert frozen.timestamp_ns(again[0]) == plain.timestamp_ns(again[0])


def test_missing_frames_leave_gaps_in_time() -> None:
    gaps = drive(missing_frames=0.3, frames=100)
    times = [gaps.timestamp_ns(index) for index in range(100)]
    steps = np.diff(times) // 100_000_000
    assert times[0] == 0
    assert steps.min() == 1
    assert steps.max() >= 2
    assert 100 / steps.sum() == pytest.approx(0.7, abs=0.12)
    shorter = drive(missing_frames=0.3, frames=60)
    assert [shorter.timestamp_ns(index) for index in range(60)] == times[:60]
    assert np.array_equal(shorter.render(59).image, gaps.render(59).image)
    slot = times[59] // 100_000_000
    assert np.array_equal(drive(frames=200).render(slot).image, gaps.render(59).image)


def test_a_drive_that_never_ends_is_refused() -> None:
    with pytest.raises(InputError, match=r"frames=20000 with missing_frames=0.5: expected at most \d+ frame times"):
        Timeline(DriveOptions(frames=20_000, missing_frames=0.5))
