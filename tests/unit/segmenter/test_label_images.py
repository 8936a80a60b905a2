# SPDX-License-Identifier: Apache-2.0
"""Backend `masks`."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from schemas.records import Image, Instance
from services.runtime.errors import InputError
from services.segmenter.backend import FrameContext, InstanceFilter
from services.segmenter.label_images import LabelImages

CHOSEN = InstanceFilter({"car", "person"}, 0.3)


def test_sure_and_potentially_dynamic_instances_are_kept(instances: Path, image: Image) -> None:
    found = LabelImages(instances, CHOSEN).segment(image, FrameContext("000000"))
    assert found.timestamp_ns == 123
    assert not found.skipped
    assert found.instances == (
        Instance(1, "car", 0.9, (3.0, 2.0, 7.0, 4.0)),
        Instance(5, "person", 1.0, (20.0, 8.0, 2.0, 2.0)),
    )
    assert found.labels.dtype == np.uint32
    assert dict(zip(*np.unique(found.labels, return_counts=True), strict=True)) == {0: 570, 1: 28, 5: 2}
    assert (found.labels[2:6, 3:10] == 1).all()


def test_a_frame_without_objects_is_not_a_skipped_one(instances: Path, image: Image) -> None:
    found = LabelImages(instances, CHOSEN).segment(image, FrameContext("000001"))
    assert (found.skipped, found.instances, int(found.labels.max())) == (False, (), 0)


@pytest.mark.parametrize("name", ["000002", "000007"])
def test_a_frame_without_mask_is_skipped_and_counted(instances: Path, image: Image, name: str) -> None:
    backend = LabelImages(instances, CHOSEN)
    found = backend.segment(image, FrameContext(name))
    assert (found.skipped, found.instances, found.labels.shape) == (True, (), (20, 30))
    assert (found.timestamp_ns, backend.missing_frames) == (123, 1)


def test_sixteen_bits_hold_more_ids(instances: Path, image: Image) -> None:
    cv2.imwrite(str(instances / "000000.png"), np.full((20, 30), 4000, dtype=np.uint16))
    (instances / "instances.json").write_text('{"000000": [{"id": 4000, "category": "car", "score": 0.5}]}')
    found = LabelImages(instances, CHOSEN).segment(image, FrameContext("000000"))
    assert found.instances == (Instance(4000, "car", 0.5, (0.0, 0.0, 30.0, 20.0)),)
    assert (found.labels == 4000).all()


def test_a_label_image_of_another_size_or_kind_is_named(instances: Path, image: Image) -> None:
    backend = LabelImages(instances, CHOSEN)
    path = instances / "000000.png"
    cv2.imwrite(str(path), np.zeros((20, 31), dtype=np.uint8))
    with pytest.raises(InputError, match=r"000000\.png: 31x20 px, expected 30x20 as its image"):
        backend.segment(image, FrameContext("000000"))
    cv2.imwrite(str(path), np.zeros((20, 30, 3), dtype=np.uint8))
    with pytest.raises(InputError, match=r"000000\.png: .*expected one channel of 8 or 16 bits"):
        backend.segment(image, FrameContext("000000"))
    path.write_bytes(b"")
    with pytest.raises(InputError, match=r"000000\.png: not a readable image"):
        backend.segment(image, FrameContext("000000"))


def test_no_folder_and_no_index(instances: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere: no such folder, expected label images and instances\.json"):
        LabelImages(tmp_path / "nowhere", CHOSEN)
    (instances / "instances.json").unlink()
    with pytest.raises(InputError, match=r"instances: no instances\.json"):
        LabelImages(instances, CHOSEN)


@pytest.mark.parametrize(
    ("index", "said"),
    [
        ("{", r"instances\.json: not JSON"),
        ("[]", r"instances\.json: a list, expected an object of frame names"),
        ({"000000": 3}, "frame 000000: 3, expected a list of"),
        ({"000000": [3]}, "frame 000000: 3, expected such as"),
        ({"000000": [{"id": 1, "category": "car"}]}, "frame 000000: .*expected such as"),
        ({"000000": [{"id": 0, "category": "car", "score": 0.5}]}, "frame 000000: .*expected such as"),
        ({"000000": [{"id": True, "category": "car", "score": 0.5}]}, "frame 000000: .*expected such as"),
        ({"000000": [{"id": 1, "category": "car", "score": 1.5}]}, "frame 000000: .*expected such as"),
        ({"000000": [{"id": 1, "category": "car", "score": 0.5}] * 2}, "frame 000000: an id stands there twice"),
    ],
)
def test_a_bad_index_is_one_line(instances: Path, index: Any, said: str) -> None:
    (instances / "instances.json").write_text(index if isinstance(index, str) else json.dumps(index))
    with pytest.raises(InputError, match=said) as caught:
        LabelImages(instances, CHOSEN)
    assert "\n" not in str(caught.value)


def test_real_masks(shared_data: Path) -> None:
    sequence = shared_data / "kitti/sequences/03"
    backend = LabelImages(sequence / "instances", InstanceFilter({"car"}, 0.3))
    image = Image(0, cv2.imread(str(sequence / "image_0/000010.png"), cv2.IMREAD_GRAYSCALE))
    found = backend.segment(image, FrameContext("000010"))
    assert found.instances
    assert set(np.unique(found.labels)) - {0} == {instance.instance_id for instance in found.instances}
    for instance in found.instances:
        x, y, width, height = (int(value) for value in instance.box_px)
        mask = found.labels == instance.instance_id
        assert mask[y : y + height, x : x + width].sum() == mask.sum() > 0
