# SPDX-License-Identifier: Apache-2.0
"""The same options and index give the same bytes: in any order, in any process, with any number of threads."""

import hashlib
import subprocess
import sys
from pathlib import Path

import pytest

from services.runtime.errors import InputError
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame
from services.simulator.options import DriveOptions
from tests.benchmark.simulator.hash import add_frame, drive_hash

EVERYTHING = {
    "width": 200,
    "height": 72,
    "lens": "radial",
    "distortion": (-0.2, 0.04, 0.0, 0.0, 0.0),
    "stereo_baseline_m": 0.4,
    "light": "low_sun",
    "shadows": True,
    "exposure_wobble": 0.5,
    "noise": 3.0,
    "motion_blur": 0.3,
    "pixel_rain": 0.01,
    "frozen_frames": 0.2,
    "missing_frames": 0.2,
}


def digest(frame: SimulatedFrame) -> str:
    total = hashlib.sha256()
    add_frame(total, frame)
    return total.hexdigest()


@pytest.fixture(scope="module")
def street_again() -> Drive:
    """The default drive, built a second time."""
    return Drive(DriveOptions(threads=2))


def test_same_bytes_in_another_order_and_from_another_street(street: Drive, street_again: Drive) -> None:
    indices = (150, 0, 200)
    forwards = {index: digest(street.render(index)) for index in sorted(indices)}
    backwards = {index: digest(street.render(index)) for index in sorted(indices, reverse=True)}
    assert forwards == backwards == {index: digest(street_again.render(index)) for index in indices}


@pytest.mark.parametrize("world", ["street", "town"])
def test_same_bytes_in_another_process_and_with_more_threads(world: str) -> None:
    here = drive_hash(DriveOptions(world=world, threads=1, **EVERYTHING), 4)
    options = [f"{name}={value!r}" for name, value in {"world": world, "threads": 2, **EVERYTHING}.items()]
    command = [sys.executable, "-m", "tests.benchmark.simulator.hash", "--frames", "4", *options]
    there = subprocess.run(
        command, cwd=Path(__file__).parents[3], capture_output=True, text=True, check=True, timeout=200
    )
    assert there.stdout.strip() == here


def test_flow_is_the_same_whatever_was_asked_before(street: Drive, street_again: Drive) -> None:
    street.render(90)
    expected = street.flow(90)
    for index in (3, 91, 90, 200):
        street.render(index)
    assert street.flow(90).flow_px.tobytes() == expected.flow_px.tobytes()
    assert street_again.flow(90).flow_px.tobytes() == expected.flow_px.tobytes()


def test_shorter_drive_is_the_beginning_of_the_longer_one(street: Drive) -> None:
    short = Drive(DriveOptions(frames=60))
    assert short.frame_count == 60
    assert digest(short.render(40)) == digest(street.render(40))


def test_another_seed_gives_another_street(street: Drive) -> None:
    other = Drive(DriveOptions(seed=8))
    assert digest(other.render(0)) != digest(street.render(0))


@pytest.mark.parametrize("index", [-1, 320])
def test_frame_outside_the_drive_is_refused(street: Drive, index: int) -> None:
    with pytest.raises(InputError, match=f"frame {index}: expected 0 to 319"):
        street.render(index)


def test_the_last_frame_has_no_flow(street: Drive) -> None:
    with pytest.raises(InputError, match="flow of frame 319: expected a frame before it"):
        street.flow(319)
