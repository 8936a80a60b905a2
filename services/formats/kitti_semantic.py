# SPDX-License-Identifier: Apache-2.0
"""KITTI's semantic-instance data set: 200 images whose instances are known (thesis 4.1.2).

`training/image_2/NAME.png` is an image, `training/instance/NAME.png` its truth: one channel of 16 bits, the class times
256 plus the instance, with Cityscapes' class ids; instance 0 is what nobody took apart. Source: KITTI's semantics
devkit (Alhaija et al., IJCV 2018; readme.txt).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.categories import category_id
from services.formats.coco import CocoAnnotation, CocoImage
from services.formats.png import read_png
from services.formats.rle import encode_mask
from services.runtime.errors import InputError

CITYSCAPES_IDS = {"person": 24, "car": 26, "truck": 27, "bus": 28, "train": 31, "motorcycle": 32, "bicycle": 33}
"""by COCO's name; Cityscapes' rider (25) is none of COCO's"""

_PER_CLASS = 256
_EXPECTED = "expected training/image_2/*.png and training/instance/*.png, as KITTI's semantics data set has them"


@dataclass(frozen=True)
class SemanticFrame:
    """One image and its truth."""

    name: str
    image: Path
    instance: Path


def semantic_frames(data: Path) -> list[SemanticFrame]:
    """The images of `data`, which may be the training/ folder itself, by name.

    Raises:
        InputError: another layout, or an image without its truth.
    """
    folder = data if (data / "instance").is_dir() else data / "training"
    images = sorted((folder / "image_2").glob("*.png"))
    if not images or not (folder / "instance").is_dir():
        raise InputError(f"--data {data}: no such data set, {_EXPECTED}")
    frames = [SemanticFrame(image.stem, image, folder / "instance" / image.name) for image in images]
    for frame in frames:
        if not frame.instance.is_file():
            raise InputError(f"{frame.instance}: no such file, expected the truth of {frame.image.name}")
    return frames


def read_instances(frame: SemanticFrame) -> npt.NDArray[np.uint16]:
    """The truth (H, W). Raises InputError for what is no PNG of one channel of 16 bits."""
    labels = read_png(frame.instance, "KITTI's instances: one channel of 16 bits")
    if labels.ndim != 2 or labels.dtype != np.uint16:
        raise InputError(f"{frame.instance}: {labels.shape} {labels.dtype}, expected one channel of 16 bits")
    return np.asarray(labels, dtype=np.uint16)


def annotations(labels: npt.NDArray[np.uint16], image: CocoImage, category: str, first_id: int) -> list[CocoAnnotation]:
    """The true instances of `category` in one image; what nobody took apart is a crowd, in which nothing is wrong."""
    known = CITYSCAPES_IDS[category]
    values = np.unique(labels[labels // _PER_CLASS == known])
    found = []
    for number, value in enumerate(values.tolist()):
        item = CocoAnnotation.of_mask(
            first_id + number, image.image_id, category_id(category), encode_mask(labels == value)
        )
        if value % _PER_CLASS == 0:
            item = CocoAnnotation(
                item.annotation_id, item.image_id, item.category_id, item.mask, item.area_px, item.box_px, is_crowd=True
            )
        found.append(item)
    return found
