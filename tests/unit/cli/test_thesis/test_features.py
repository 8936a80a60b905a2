# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis features` on a made-up sequence and on a recorded session."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from schemas import topics
from schemas.codec import encode
from schemas.records import Image, MotionState, Objects, ObjectTrack
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from services.formats.png import write_png
from services.recorder.session_writer import SessionWriter
from services.runtime.session_file import RecordedMessage

CALIBRATION = "P0: 200 0 96 0 0 200 48 0 0 0 1 0\n"


def _texture(random: np.random.Generator) -> np.ndarray:
    coarse = random.integers(0, 256, (48, 96), dtype=np.uint8)
    return cv2.resize(coarse, (384, 192), interpolation=cv2.INTER_NEAREST)


def _sequence(folder: Path, *, moving: bool | None) -> None:
    """Three frames of texture, a car over the left half of which `moving` is said."""
    for name in ("image_0", "instances"):
        (folder / name).mkdir(parents=True)
    (folder / "calib.txt").write_text(CALIBRATION)
    random = np.random.default_rng(4)
    index = {}
    for number in range(3):
        write_png(folder / "image_0" / f"{number:06d}.png", _texture(random))
        labels = np.zeros((192, 384), dtype=np.uint8)
        labels[30:170, 10:170] = 1
        write_label_image(folder / "instances" / f"{number:06d}.png", labels)
        index[f"{number:06d}"] = (LabelledInstance(1, "car", 0.9, moving),)
    write_label_index(folder / "instances", index)


@pytest.mark.parametrize(("moving", "parked"), [(False, 1.0), (True, 0.0), (None, None)])
def test_parked_cars_keep_features_balanced_only_where_they_are_known_to_be_parked(
    moving: bool | None, parked: float | None, kinemap: Any, tmp_path: Path
) -> None:
    _sequence(tmp_path / "kitti" / "sequences" / "05", moving=moving)
    ended = kinemap("thesis", "features", "--data", "kitti", "--sequences", "05", "--out", "out")
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "features.json").read_text())["05"]
    assert found["parked_share"] == parked
    skew = {kind: numbers["mean"] for kind, numbers in found["skew"].items()}
    assert skew["without potentially dynamic objects"] > skew["all features"] + 0.15
    if moving is None:
        assert skew["without moving objects"] is None
        assert found["observations"]["unknown"] == 3
    else:
        kept = "without potentially dynamic objects" if moving else "all features"
        assert skew["without moving objects"] == pytest.approx(skew[kept])


def _record(path: Path, frames: int) -> None:
    """A session in which a parked car stands on the left, one that moves and an undecided one on the right."""
    track_image = np.zeros((192, 384), dtype=np.uint32)
    track_image[30:170, 10:100], track_image[30:100, 250:300], track_image[120:170, 320:370] = 11, 12, 13
    states = {11: MotionState.NON_MOVING, 12: MotionState.MOVING, 13: MotionState.UNDECIDED}
    rows = tuple(ObjectTrack(n, "car", 0.9, state, 0.5, (0.0, 0.0, 1.0, 1.0), 3) for n, state in states.items())
    writer = SessionWriter(path, "made")
    for sequence in range(frames):
        time_ns = sequence * 100_000_000
        records = (
            (topics.IMAGE, Image(time_ns, _texture(np.random.default_rng(sequence)))),
            (topics.OBJECTS, Objects(time_ns, track_image, rows)),
        )
        writer.append(
            [RecordedMessage(topic.key, sequence, time_ns, encode(topic, record)) for topic, record in records]
        )
    writer.finish()
    writer.close()


def test_a_recorded_run_tells_what_its_tracker_said(kinemap: Any, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    _record(tmp_path / "run" / "session.mcap", 3)
    ended = kinemap("thesis", "features", "run", "--out", "out")
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "features.json").read_text())["run"]
    assert found["frames"] == 3
    assert found["observations"] == {"standing": 3, "moving": 3, "undecided": 3, "unknown": 0}
    assert found["parked_share_cars"] == 0.5
    counts = found["by_frame"]["000002"]
    everything, moving = counts["all features"], counts["without moving objects"]
    dynamic = counts["without potentially dynamic objects"]
    assert dynamic[0] < moving[0] == everything[0]  # the parked car's are kept
    assert dynamic[1] == moving[1] < everything[1]  # neither the moving one's nor the undecided one's
    assert kinemap("thesis", "features", "run", "--out", "out", "--frames", "2").code == 0
    assert json.loads((tmp_path / "out" / "features.json").read_text())["run"]["frames"] == 2


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ((), ("expected folders of runs, or --data",)),
        (("somewhere",), ("somewhere: no session.mcap here",)),
        (("--data", "kitti"), ("no sequences/04 with image_0 or image_2",)),
        (("--data", "kitti", "--sequences", "05,05"), ("--sequences 05,05: expected different names",)),
        (("--data", "nowhere"), ("--data nowhere: no such folder",)),
    ],
)
def test_bad_input_is_one_line(
    tmp_path: Path, kinemap: Any, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    (tmp_path / "kitti" / "sequences" / "05" / "image_0").mkdir(parents=True)
    kinemap("thesis", "features", *arguments, "--out", "out").is_one_line(*parts)


@pytest.mark.usefixtures("without_network")
def test_a_sequence_without_masks_is_refused(kinemap: Any, tmp_path: Path) -> None:
    folder = tmp_path / "kitti" / "sequences" / "05"
    _sequence(folder, moving=None)
    (folder / "instances").rename(folder / "elsewhere")
    ended = kinemap("thesis", "features", "--data", "kitti", "--sequences", "05", "--out", "out")
    ended.is_one_line("sequences/05: no instances/")


def test_a_real_sequence_has_its_features_on_both_sides(shared_data: Path, kinemap: Any, tmp_path: Path) -> None:
    data = shared_data / "kitti"
    ended = kinemap("thesis", "features", "--data", data, "--sequences", "03", "--frames", "3", "--out", "out")
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "features.json").read_text())["03"]
    assert found["skew"]["all features"]["features"] == 2000.0
    assert found["skew"]["all features"]["mean_absolute"] < 0.2
    assert found["skew"]["without moving objects"]["mean"] is None
