# SPDX-License-Identifier: Apache-2.0
"""Video files."""

from pathlib import Path

import numpy as np
import pytest

from services.camera.sources.source import SourceFrame
from services.camera.sources.video_file import VideoFile
from services.runtime.errors import InputError


def _frame(source: VideoFile, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def test_frames_come_in_order_until_the_end(video: Path) -> None:
    source = VideoFile(video)
    assert (source.frame_count, source.rate_hz) == (10, 12.5)
    frames = [_frame(source, index) for index in range(10)]
    assert source.frame(10) is None
    assert [frame.timestamp_ns for frame in frames] == [80_000_000 * index for index in range(10)]
    assert [frame.name for frame in frames[:2]] == ["000000", "000001"]
    brightness = [float(frame.image.pixels.mean()) for frame in frames]
    np.testing.assert_allclose(brightness, 20 * np.arange(10), atol=4)
    assert frames[0].calibration.intrinsics[1, 1] == 21
    source.close()


def test_a_camera_that_goes_on_in_the_middle_sees_the_same(video: Path) -> None:
    through = VideoFile(video)
    frames = [_frame(through, index) for index in range(10)]
    resumed = VideoFile(video)
    for index in (7, 8, 3, 9):
        again = _frame(resumed, index)
        assert again.timestamp_ns == frames[index].timestamp_ns
        np.testing.assert_array_equal(again.image.pixels, frames[index].image.pixels)


def test_bad_videos_are_one_line(video: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.mp4: no such file"):
        VideoFile(tmp_path / "none.mp4")
    (tmp_path / "text.mp4").write_text("no video")
    with pytest.raises(InputError, match=r"text\.mp4: cannot be decoded"):
        VideoFile(tmp_path / "text.mp4")
    calibration = tmp_path / "drive.toml"
    calibration.write_text(calibration.read_text().replace("24", "25"))
    with pytest.raises(InputError, match=r"drive\.avi: 32x24 px, expected 32x25 as in .*drive\.toml"):
        VideoFile(video)
    calibration.unlink()
    with pytest.raises(InputError, match=r"no calibration: expected .*drive\.toml or .*calibration\.toml"):
        VideoFile(video)
