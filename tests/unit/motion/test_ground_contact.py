# SPDX-License-Identifier: Apache-2.0
"""Where masks touch the ground."""

import numpy as np

from services.motion.ground_contact import find_contact


def test_wheels_carry_what_is_between_them() -> None:
    labels = np.zeros((80, 120), np.uint32)
    labels[20:50, 20:81] = 3
    labels[50:56, 28:35] = 3
    labels[50:56, 66:73] = 3
    contact = find_contact(labels, 3, (20, 20, 61, 36))
    assert contact is not None
    assert not contact.hidden
    np.testing.assert_allclose(contact.rows_at(np.array([30, 50, 70])), 55.0)


def test_the_climbing_sides_are_left_out() -> None:
    labels = np.zeros((80, 120), np.uint32)
    for column in range(20, 81):
        labels[20 : 60 - abs(column - 50), column] = 1
    contact = find_contact(labels, 1, (20, 20, 61, 40))
    assert contact is not None
    assert contact.first_column_px > 25
    assert contact.rows_at(np.array([0]))[0] == contact.row_px[0]


def test_an_instance_before_it_hides_the_contact() -> None:
    labels = np.zeros((80, 120), np.uint32)
    labels[20:50, 20:60] = 1
    labels[50:70, 10:70] = 2
    behind, before = find_contact(labels, 1, (20, 20, 40, 30)), find_contact(labels, 2, (10, 50, 60, 20))
    assert behind is not None
    assert behind.hidden
    assert before is not None
    assert not before.hidden


def test_the_image_border_hides_the_contact() -> None:
    labels = np.zeros((80, 120), np.uint32)
    labels[40:80, 20:60] = 1
    contact = find_contact(labels, 1, (20, 40, 40, 40))
    assert contact is not None
    assert contact.hidden


def test_a_mask_of_nothing_has_no_contact() -> None:
    assert find_contact(np.zeros((20, 20), np.uint32), 1, (2, 2, 10, 10)) is None
