# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from services.formats.png import read_png, write_png
from services.runtime.errors import InputError


@pytest.mark.parametrize("bits", [np.uint8, np.uint16])
@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3)])
def test_pixels_come_back_as_they_are(tmp_path: Path, bits: type, shape: tuple[int, ...]) -> None:
    pixels = np.random.default_rng(1).integers(0, np.iinfo(bits).max, shape, dtype=bits, endpoint=True)
    write_png(tmp_path / "a.png", pixels)
    read = read_png(tmp_path / "a.png", "a picture")
    assert read.dtype == bits
    np.testing.assert_array_equal(read, pixels)


def test_a_damaged_file_is_one_line_and_nothing_else(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.png"
    write_png(path, np.random.default_rng(1).integers(0, 255, (40, 40), dtype=np.uint8))
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 0x40
    for data in (b"", whole[:20], whole[: len(whole) // 2], whole[:-3], bytes(damaged), b"GIF89a" + whole[6:]):
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"a\.png: not a whole PNG file, expected a picture"):
            read_png(path, "a picture")
    assert capfd.readouterr() == ("", "")
    path.write_bytes(whole)
    assert read_png(path, "a picture").shape == (40, 40)
