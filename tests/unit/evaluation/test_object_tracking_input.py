# SPDX-License-Identifier: Apache-2.0
"""Readers and KITTI's rules of what counts, the latter against trackeval's own reader of KITTI and of KITTI MOTS."""

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.evaluation.object_tracking.inputs import known_categories, read_sequence_pairs
from services.evaluation.object_tracking.matching import match_sequence
from services.evaluation.object_tracking.metrics import MatchedFrame
from services.formats.kitti_tracking import TrackedBox, read_detections, write_kitti_tracking
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from services.formats.mots import CAR, IGNORED, PERSON, MotsObject, mots_id, write_mots_png, write_mots_text
from services.formats.rle import encode_mask
from services.runtime.errors import InputError

HEIGHT, WIDTH, FRAMES = 120, 200, 8


def _matched(found: Path, truth: Path, category: str = "car") -> list[MatchedFrame]:
    (pair,) = read_sequence_pairs(found, truth)
    return match_sequence(pair.truth, pair.found, category)


def _boxes(seed: int) -> tuple[list[TrackedBox], list[TrackedBox]]:
    """Cars, vans and walkers of all sizes, some hidden or cut off, regions that nobody labelled, a fair tracker."""
    random = np.random.default_rng(seed)
    truth, found = [], []
    for number in range(14):
        category = str(random.choice(["Car", "Car", "Van", "Pedestrian", "Person", "Truck"]))
        size = random.uniform(12, 60, 2)
        start, speed = random.uniform(0, 120, 2), random.uniform(-4, 4, 2)
        for frame in range(int(random.integers(0, 3)), FRAMES):
            corner = start + speed * frame
            box = (*corner.tolist(), *(corner + size).tolist())
            hidden, cut = int(random.choice([0, 1, 2, 3])), int(random.choice([0, 0, 0, 1]))
            truth.append(TrackedBox(frame, number, category, box, cut, hidden))
            if random.random() < 0.8:
                moved = tuple(float(v) for v in np.array(box) + np.tile(random.normal(0, 2, 2), 2))
                called = "Pedestrian" if category in ("Pedestrian", "Person") else "Car"
                found.append(TrackedBox(frame, number + 50 * int(random.random() < 0.1), called, moved, score=0.5))
    for frame in range(FRAMES):
        left, top = (float(value) for value in random.uniform(0, 150, 2))
        truth.append(TrackedBox(frame, -1, "DontCare", (left, top, left + 60, top + 60)))
        invented = (left + 5, top + 5, left + 45, top + 55)
        found.append(TrackedBox(frame, 900 + frame, "Car", invented, score=0.9))
    return truth, found


def _reference(dataset_class: Any, folder: Path, category: str, **config: object) -> list[MatchedFrame]:
    with contextlib.redirect_stdout(io.StringIO()):
        dataset = dataset_class(
            {"GT_FOLDER": str(folder / "gt"), "TRACKERS_FOLDER": str(folder / "trackers"), "PRINT_CONFIG": False}
            | config
        )
        raw = dataset.get_raw_seq_data("mine", "0000")
        data = dataset.get_preprocessed_seq_data(raw, category)
    return [
        MatchedFrame(*rows) for rows in zip(data["gt_ids"], data["tracker_ids"], data["similarity_scores"], strict=True)
    ]


def _assert_same(ours: list[MatchedFrame], theirs: list[MatchedFrame]) -> None:
    assert len(ours) <= len(theirs)
    for frame, reference in zip(ours, theirs, strict=False):
        assert frame.iou.shape == reference.iou.shape
        np.testing.assert_allclose(frame.iou, reference.iou, atol=1e-12)
    assert sum(frame.iou.size for frame in ours) > 5


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("category", ["car", "pedestrian"])
def test_boxes_count_by_kittis_rules(tmp_path: Path, seed: int, category: str) -> None:
    datasets = pytest.importorskip("trackeval.datasets")
    truth, found = _boxes(seed)
    label, result = tmp_path / "gt" / "label_02" / "0000.txt", tmp_path / "trackers" / "mine" / "data" / "0000.txt"
    for path, boxes in ((label, truth), (result, found)):
        path.parent.mkdir(parents=True)
        write_kitti_tracking(path, boxes)
    (tmp_path / "gt" / "evaluate_tracking.seqmap.training").write_text(f"0000 empty 000000 {FRAMES:06d}\n")
    ours = _matched(result, label, category)
    _assert_same(ours, _reference(datasets.Kitti2DBox, tmp_path, category))
    assert sum(frame.found_ids.size for frame in ours) < len(found)


def _rectangles(boxes: list[TrackedBox], seed: int) -> list[MotsObject]:
    """The boxes as masks that do not overlap."""
    objects = []
    for frame in range(FRAMES):
        free = np.ones((HEIGHT, WIDTH), dtype=bool)
        for box in (box for box in boxes if box.frame == frame and box.category in ("Car", "Pedestrian", "DontCare")):
            left, top, right, bottom = (max(round(value), 0) for value in box.box_px)
            mask = np.zeros_like(free)
            mask[top:bottom, left:right] = True
            mask &= free
            free &= ~mask
            if not mask.any():
                continue
            class_id = {"Car": CAR, "Pedestrian": PERSON, "DontCare": IGNORED}[box.category]
            number = 0 if class_id == IGNORED else box.object_id
            objects.append(MotsObject(frame, mots_id(class_id, number), class_id, encode_mask(mask)))
    return objects


@pytest.mark.parametrize("seed", [0, 1])
def test_masks_count_by_the_rules_of_kitti_mots(tmp_path: Path, seed: int) -> None:
    datasets = pytest.importorskip("trackeval.datasets")
    truth, found = _boxes(seed)
    label, result = tmp_path / "gt" / "0000.txt", tmp_path / "trackers" / "mine" / "data" / "0000.txt"
    for path, boxes in ((label, truth), (result, found)):
        path.parent.mkdir(parents=True)
        write_mots_text(path, _rectangles(boxes, seed))
    config = {"GT_LOC_FORMAT": "{gt_folder}/{seq}.txt", "SEQ_INFO": {"0000": FRAMES}}
    ours = _matched(result, label)
    _assert_same(ours, _reference(datasets.KittiMOTS, tmp_path, "car", **config))


def test_real_detections_count_by_kittis_rules(shared_data: Path, tmp_path: Path) -> None:
    datasets = pytest.importorskip("trackeval.datasets")
    folder = shared_data / "kitti_tracking"
    label, result = tmp_path / "gt" / "label_02" / "0000.txt", tmp_path / "trackers" / "mine" / "data" / "0000.txt"
    for path in (label, result):
        path.parent.mkdir(parents=True)
    label.write_bytes((folder / "label" / "0000.txt").read_bytes())
    boxes = [b for b in read_detections(folder / "pointrcnn_car" / "0000.txt") if b.score is not None and b.score > 0]
    write_kitti_tracking(
        result,
        [TrackedBox(b.frame, number, b.category, b.box_px, score=b.score) for number, b in enumerate(boxes)],
    )
    (tmp_path / "gt" / "evaluate_tracking.seqmap.training").write_text("0000 empty 000000 000154\n")
    _assert_same(_matched(result, label), _reference(datasets.Kitti2DBox, tmp_path, "car"))


def _label_folder(path: Path, frames: dict[str, dict[int, str]]) -> Path:
    path.mkdir(parents=True)
    for name, rows in frames.items():
        labels = np.zeros((20, 120), dtype=np.uint16)
        for place, label in enumerate(rows):
            labels[:, 20 * place : 20 * place + 15] = label
        write_label_image(path / f"{name}.png", labels)
    write_label_index(path, {n: [LabelledInstance(i, c) for i, c in rows.items()] for n, rows in frames.items()})
    return path


def test_label_images_and_mots_meet(tmp_path: Path) -> None:
    folder = _label_folder(tmp_path / "a", {"000000": {3: "car", 4: "person"}, "000002": {3: "car", 4: "person"}})
    mask = np.zeros((20, 120), dtype=bool)
    mask[:, :15] = True
    car = [MotsObject(frame, 1007, CAR, encode_mask(mask)) for frame in (0, 2)]
    write_mots_text(tmp_path / "found.txt", car)
    frames = _matched(tmp_path / "found.txt", folder)
    assert [frame.iou.tolist() for frame in frames] == [[[1.0]], [[1.0]]]
    (tmp_path / "images").mkdir()
    for item in car:
        write_mots_png(tmp_path / "images" / f"{item.frame:06d}.png", [item], 20, 120)
    assert [frame.iou.tolist() for frame in _matched(tmp_path / "images", folder)] == [[[1.0]], [[1.0]]]
    (pair,) = read_sequence_pairs(folder, folder)
    assert known_categories([pair]) == ["car", "pedestrian"]


def test_folders_of_sequences_are_paired_by_name(tmp_path: Path) -> None:
    for side in ("truth", "found"):
        for name in ("00", "01"):
            _label_folder(tmp_path / side / name / "instances", {"0": {3: "car"}})
    assert [pair.truth.name for pair in read_sequence_pairs(tmp_path / "found", tmp_path / "truth")] == ["00", "01"]
    texts = tmp_path / "texts"
    texts.mkdir()
    (texts / "00.txt").write_text("")
    (texts / "02.txt").write_text("")
    with pytest.raises(InputError, match="no sequence '01', expected one for each of 00, 01"):
        read_sequence_pairs(texts, tmp_path / "truth")


def test_nonsense_is_one_clear_line(tmp_path: Path) -> None:
    truth = _label_folder(tmp_path / "truth", {"0": {3: "car"}, "1": {}})
    boxes = tmp_path / "boxes.txt"
    write_kitti_tracking(boxes, [TrackedBox(0, 3, "Car", (0.0, 0.0, 15.0, 20.0))])
    ids = tmp_path / "ids.txt"
    write_kitti_tracking(ids, [TrackedBox(0, -1, "Car", (0.0, 0.0, 15.0, 20.0))])
    (tmp_path / "odd.txt").write_text("1 2 3\n")
    (tmp_path / "empty").mkdir()
    size = tmp_path / "size.txt"
    write_mots_text(size, [MotsObject(0, 1001, CAR, encode_mask(np.ones((5, 5))))])
    for found, against, said in (
        (boxes, truth, "boxes and masks, expected two of a kind"),
        (ids, boxes, "every id is -1, expected ids that last"),
        (tmp_path / "odd.txt", boxes, "odd.txt:1: 3 fields, expected MOTS text"),
        (tmp_path / "none", truth, "none: no such file or folder"),
        (tmp_path / "empty", truth, "no sequence, expected MOTS text"),
        (_label_folder(tmp_path / "other", {"7": {3: "car"}}), truth, "expected names such as '0'; found '7'"),
        (size, truth, "sequence truth frame 0: masks of 5x5 and 120x20 px, expected one size"),
    ):
        with pytest.raises(InputError) as error:
            _matched(found, against)
        assert said in str(error.value)
        assert "\n" not in str(error.value)
    pairs = read_sequence_pairs(truth, truth)
    with pytest.raises(InputError, match="category 'pedestrian': not in the truth, expected one of car"):
        known_categories(pairs, ["pedestrian"])
    (tmp_path / "nobody.txt").write_text("")
    with pytest.raises(InputError, match="nobody: no object in the truth"):
        known_categories(read_sequence_pairs(tmp_path / "nobody.txt", tmp_path / "nobody.txt"))
