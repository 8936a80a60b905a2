# SPDX-License-Identifier: Apache-2.0
"""COCO's categories."""

import pytest

from schemas.categories import (
    CATEGORY_IDS,
    CATEGORY_NAMES,
    NO_CATEGORY,
    category_id,
    category_name,
    is_category,
)


def test_there_are_eighty_and_names_and_ids_agree() -> None:
    assert len(set(CATEGORY_NAMES)) == len(set(CATEGORY_IDS)) == 80
    assert list(CATEGORY_IDS) == sorted(CATEGORY_IDS)
    assert (min(CATEGORY_IDS), max(CATEGORY_IDS)) == (1, 90)
    for number, name in zip(CATEGORY_IDS, CATEGORY_NAMES, strict=True):
        assert category_id(name) == number
        assert category_name(number) == name
        assert is_category(name)


@pytest.mark.parametrize(
    ("name", "number", "position"),
    [("person", 1, 0), ("car", 3, 2), ("truck", 8, 7), ("dog", 18, 16), ("tv", 72, 62), ("toothbrush", 90, 79)],
)
def test_official_ids_and_network_positions(name: str, number: int, position: int) -> None:
    assert category_id(name) == number
    assert CATEGORY_NAMES[position] == name


def test_what_is_none_of_them() -> None:
    assert not is_category("van")
    assert category_id("van") == NO_CATEGORY
    assert category_name(NO_CATEGORY) == ""
    assert category_name(12) == ""
