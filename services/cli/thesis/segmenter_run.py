# SPDX-License-Identifier: Apache-2.0
"""The configured segmenter, whatever it is, over single images."""

import time
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import Image, Instances
from services.cli.flags import Overrides, merge_overrides, parse_settings
from services.runtime.config import load_config
from services.runtime.errors import InputError
from services.segmenter.backend import FrameContext, InstanceBackend
from services.segmenter.label_images import LabelImages
from services.segmenter.no_instances import NoInstances
from services.segmenter.service import choose_backend
from services.segmenter.truth import TrueLabels

_FRAME_NS = 100_000_000


def open_segmenter(
    source: Path,
    instances: Path | None,
    *,
    category: str | None = None,
    min_score: float | None = None,
    weights: str | None = None,
    config: Path | None = None,
    settings: list[str] | None = None,
) -> InstanceBackend:
    """The segmenter that the configuration names for `source`, with label images in `instances` where they are given.

    `weights` ask for a network with these.

    Raises InputError where there is none that could find anything in images alone.
    """
    flags: Overrides = {
        "camera": {"input": str(source)},
        "segmenter": {
            "instances": instances,
            "categories": None if category is None else (category,),
            "min_score": min_score,
            "weights": weights,
            "backend": None if weights is None else "solov2",
        },
    }
    backend = choose_backend(load_config(config, merge_overrides(parse_settings(settings), flags)))
    if isinstance(backend, NoInstances | TrueLabels):
        backend.close()
        raise InputError(f"{source}: no instances/ and no segmenter that needs none, expected --predictions FOLDER")
    return backend


def read_image(path: Path) -> npt.NDArray[np.uint8]:
    """The pixels, (H, W) grey or (H, W, 3) blue-green-red. Raises InputError for what is no whole image."""
    try:
        data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
        pixels = cv2.imdecode(data, cv2.IMREAD_ANYCOLOR) if data.size else None
    except OSError as error:
        raise InputError(f"image {path}: cannot be read ({error.strerror})") from error
    except cv2.error:
        pixels = None
    if pixels is None:
        raise InputError(f"image {path}: not a readable image, expected a whole PNG or JPEG file")
    return np.asarray(pixels, dtype=np.uint8)


@dataclass
class TimedSegmenter:
    """Segments images one by one and adds up the time that the segmenter alone took."""

    backend: InstanceBackend
    frames: int = 0
    spent_s: float = 0.0

    @property
    def seconds(self) -> float | None:
        """None where label images were read: no network ran."""
        return None if isinstance(self.backend, LabelImages) else self.spent_s

    def segment(self, name: str, pixels: npt.NDArray[np.uint8]) -> Instances:
        """The instances of one image, under a time of its own."""
        image = Image(self.frames * _FRAME_NS, pixels)
        self.frames += 1
        began_s = time.perf_counter()
        instances = self.backend.segment(image, FrameContext(name))
        self.spent_s += time.perf_counter() - began_s
        return instances
