# SPDX-License-Identifier: Apache-2.0
"""Stage 2 of the thesis on KITTI MoSeg: the derived masks, and predicted ones against them (5.1.2.1)."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from services.evaluation.bench.table import NOTHING, BenchTable
from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.moving_masks.score import FlagRules, MovingMaskResult
from services.evaluation.moving_masks.table import describe_moving
from services.evaluation.progress import Progress, silent
from services.evaluation.run.outcome import Report
from services.evaluation.thesis.moving_cars import moving_cars
from services.evaluation.thesis.published import THESIS_MOVING_MEAN_IOU
from services.formats.kitti_moseg import MosegFrame, read_boxes, read_cars
from services.formats.png import write_png


@dataclass
class DerivedMasks:
    """What there is in the masks that were derived: frames, boxes, and pixels by class."""

    frames: int = 0
    boxes: int = 0
    moving_boxes: int = 0
    frames_with_movers: int = 0
    non_moving_px: int = 0
    moving_px: int = 0

    @property
    def moving_share(self) -> float | None:
        """Of the cars' pixels; None without a car."""
        cars = self.non_moving_px + self.moving_px
        return self.moving_px / cars if cars else None


def derive_masks(frames: Sequence[MosegFrame], folder: Path, progress: Progress = silent) -> DerivedMasks:
    """Write `folder`/NAME.png of every frame: 0 background, 1 a car that stands, 2 one that moves.

    Raises:
        InputError: a mask or boxes that cannot be read.
    """
    derived = DerivedMasks()
    for frame in progress(frames, "deriving masks"):
        boxes = read_boxes(frame)
        mask = moving_cars(read_cars(frame), boxes)
        write_png(folder / f"{frame.name}.png", mask)
        derived.frames += 1
        derived.boxes += len(boxes)
        derived.moving_boxes += sum(box.moving for box in boxes)
        moving_px = int(np.count_nonzero(mask == MaskClass.MOVING))
        derived.frames_with_movers += moving_px > 0
        derived.moving_px += moving_px
        derived.non_moving_px += int(np.count_nonzero(mask == MaskClass.NON_MOVING))
    return derived


def moseg_table(result: MovingMaskResult, name: str) -> BenchTable:
    """IoU of each class and their mean, beside the thesis'."""
    header = ("", "moving", "non-moving", "background", "mean IoU", "precision, moving", "recall, moving")
    total = result.total
    classes = (MaskClass.MOVING, MaskClass.NON_MOVING, MaskClass.BACKGROUND)
    values = [total.iou(kind) if kind in total.classes else None for kind in classes]
    ours = (name, *map(_number, (*values, total.mean_iou, total.precision, total.recall)))
    dashes = (NOTHING,) * 3
    thesis = ("thesis, two-stream network", *dashes, _number(THESIS_MOVING_MEAN_IOU), NOTHING, NOTHING)
    return BenchTable(header, (ours, thesis))


def describe_moseg(derived: DerivedMasks, result: MovingMaskResult | None) -> Report:
    """All of it for JSON; `score` is null where nothing was predicted."""
    return {
        "derived": {**asdict(derived), "moving_share": derived.moving_share},
        "thesis_mean_iou": THESIS_MOVING_MEAN_IOU,
        "score": None if result is None else describe_moving(result, FlagRules()),
    }


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"
