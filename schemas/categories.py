# SPDX-License-Identifier: Apache-2.0
"""COCO's 80 categories of things: names on the bus, official ids (1..90 with gaps) where a number is stored.

Source: Lin et al., "Microsoft COCO: Common Objects in Context", ECCV 2014, the 2017 instance annotations.
A network trained on COCO numbers its classes by position in `CATEGORY_NAMES`.
"""

from types import MappingProxyType
from typing import Final

NO_CATEGORY: Final = -1
"""The id of what belongs to no category."""

_NAME_BY_ID: Final = {
    1: "person", 2: "bicycle", 3: "car", 4: "motorcycle", 5: "airplane", 6: "bus", 7: "train", 8: "truck", 9: "boat",
    10: "traffic light", 11: "fire hydrant", 13: "stop sign", 14: "parking meter", 15: "bench", 16: "bird", 17: "cat",
    18: "dog", 19: "horse", 20: "sheep", 21: "cow", 22: "elephant", 23: "bear", 24: "zebra", 25: "giraffe",
    27: "backpack", 28: "umbrella", 31: "handbag", 32: "tie", 33: "suitcase", 34: "frisbee", 35: "skis",
    36: "snowboard", 37: "sports ball", 38: "kite", 39: "baseball bat", 40: "baseball glove", 41: "skateboard",
    42: "surfboard", 43: "tennis racket", 44: "bottle", 46: "wine glass", 47: "cup", 48: "fork", 49: "knife",
    50: "spoon", 51: "bowl", 52: "banana", 53: "apple", 54: "sandwich", 55: "orange", 56: "broccoli", 57: "carrot",
    58: "hot dog", 59: "pizza", 60: "donut", 61: "cake", 62: "chair", 63: "couch", 64: "potted plant", 65: "bed",
    67: "dining table", 70: "toilet", 72: "tv", 73: "laptop", 74: "mouse", 75: "remote", 76: "keyboard",
    77: "cell phone", 78: "microwave", 79: "oven", 80: "toaster", 81: "sink", 82: "refrigerator", 84: "book",
    85: "clock", 86: "vase", 87: "scissors", 88: "teddy bear", 89: "hair drier", 90: "toothbrush",
}  # fmt: skip

CATEGORY_IDS: Final = tuple(_NAME_BY_ID)
CATEGORY_NAMES: Final = tuple(_NAME_BY_ID.values())
_ID_BY_NAME: Final = MappingProxyType({name: number for number, name in _NAME_BY_ID.items()})


def is_category(name: str) -> bool:
    """Whether `name` is one of COCO's 80."""
    return name in _ID_BY_NAME


def category_id(name: str) -> int:
    """COCO's id of a category; NO_CATEGORY for a name that is none of the 80."""
    return _ID_BY_NAME.get(name, NO_CATEGORY)


def category_name(number: int) -> str:
    """The category's name; empty for NO_CATEGORY and for the numbers that COCO leaves out."""
    return _NAME_BY_ID.get(number, "")
