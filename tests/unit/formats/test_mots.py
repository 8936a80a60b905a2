# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.formats.mots import (
    CAR,
    IGNORED,
    PERSON,
    MotsObject,
    mots_id,
    read_mots_png,
    read_mots_text,
    write_mots_png,
    write_mots_text,
)
from services.formats.rle import encode_mask
from services.runtime.errors import InputError


def _object(frame: int, class_id: int, number: int, left: int) -> MotsObject:
    mask = np.zeros((20, 40), dtype=bool)
    mask[5:15, left : left + 8] = True
    return MotsObject(frame, mots_id(class_id, number), class_id, encode_mask(mask))


SEQUENCE = (_object(0, CAR, 1, 0), _object(0, PERSON, 5, 10), _object(2, CAR, 1, 3), _object(2, IGNORED, 0, 30))


def test_text_comes_back_in_order(tmp_path: Path) -> None:
    write_mots_text(tmp_path / "0000.txt", reversed(SEQUENCE))
    assert read_mots_text(tmp_path / "0000.txt") == SEQUENCE
    assert (tmp_path / "0000.txt").read_text().startswith("0 1001 1 20 40 ")


def test_images_come_back(tmp_path: Path) -> None:
    write_mots_png(tmp_path / "000002.png", SEQUENCE[2:], 20, 40)
    assert read_mots_png(tmp_path / "000002.png", 2) == SEQUENCE[2:]
    assert cv2.imread(str(tmp_path / "000002.png"), cv2.IMREAD_UNCHANGED)[7, 31] == 10000


def test_a_sequence_without_objects_is_one(tmp_path: Path) -> None:
    (tmp_path / "empty.txt").write_text("\n")
    assert read_mots_text(tmp_path / "empty.txt") == ()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("0 1001 1 20 40", ":2: 5 fields, expected 6"),
        ("x 1001 1 20 40 abc", ":2: frame 'x', expected a whole number"),
        ("-1 1001 1 20 40 abc", ":2: frame '-1', expected a whole number of at least 0"),
        ("0 1001 1 0 40 abc", ":2: height '0'"),
        ("0 1001 1 99999999 40 abc", ":2: size"),
        ("0 1001 1 20 40 00", ":2: a mask of"),
        ("0 1001 1 20 40 \x7f", ":2: a mask that is no compressed RLE"),
    ],
)
def test_wrong_lines_are_named(tmp_path: Path, line: str, said: str) -> None:
    path = tmp_path / "0000.txt"
    path.write_text(f"\n{line}\n")
    with pytest.raises(InputError, match="0000") as error:
        read_mots_text(path)
    assert said in str(error.value)


def test_what_cannot_be_in_one_image_is_refused(tmp_path: Path) -> None:
    overlapping = (_object(4, CAR, 1, 0), _object(4, CAR, 2, 4))
    with pytest.raises(InputError, match="frame 4: masks overlap"):
        write_mots_text(tmp_path / "a.txt", overlapping)
    with pytest.raises(InputError, match="frame 4: id 1001 stands there twice"):
        write_mots_text(tmp_path / "a.txt", (_object(4, CAR, 1, 0), _object(4, CAR, 1, 20)))
    with pytest.raises(InputError, match="expected 64x20"):
        write_mots_png(tmp_path / "a.png", overlapping[:1], 20, 64)
    with pytest.raises(InputError, match="no more ids"):
        mots_id(CAR, 1000)


def test_an_image_that_is_none_of_mots_is_named(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.full((4, 4), 3, dtype=np.uint16))
    with pytest.raises(InputError, match="id 3, expected class"):
        read_mots_png(tmp_path / "a.png", 0)
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((4, 4, 3), dtype=np.uint16))
    with pytest.raises(InputError, match="expected one channel"):
        read_mots_png(tmp_path / "b.png", 0)
