# SPDX-License-Identifier: Apache-2.0
"""The same options and index give the same bytes, in any order and with any number of threads."""

import hashlib

import pytest

from services.runtime.errors import InputError
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame
from services.simulator.options import DriveOptions


def digest(frame: SimulatedFrame) -> str:
    total = hashlib.sha256()
    for array in (frame.image, frame.depth_m, frame.labels, frame.world_from_camera):
        total.update(array.tobytes())
    total.update(repr([(i.instance_id, i.moving, i.box_px, i.velocity_m_s.tolist()) for i in frame.instances]).encode())
    return total.hexdigest()


def test_same_bytes_in_another_order_and_from_another_street(street: Drive) -> None:
    indices = (150, 0, 200)
    forwards = {index: digest(street.render(index)) for index in sorted(indices)}
    backwards = {index: digest(street.render(index)) for index in sorted(indices, reverse=True)}
    again = Drive(DriveOptions(threads=2))
    assert forwards == backwards == {index: digest(again.render(index)) for index in indices}


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
