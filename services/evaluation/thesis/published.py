# SPDX-License-Identifier: Apache-2.0
"""Numbers that others published, to stand beside ours. "The thesis" is Robust map building for robot navigation in
dynamic environments, 2021."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class PublishedErrors:
    """Mean ATE RMSE in metres of a monocular system on whole sequences of KITTI odometry, Sim(3) aligned."""

    name: str
    source: str
    ate_m: Mapping[str, float]


_DYNASLAM_PAPER = "Bescos et al., DynaSLAM, RA-L 2018, its table of monocular KITTI"

PUBLISHED_ODOMETRY = (
    PublishedErrors("ORB-SLAM", _DYNASLAM_PAPER, MappingProxyType({"04": 1.62, "05": 4.85, "07": 2.26})),
    PublishedErrors("DynaSLAM", _DYNASLAM_PAPER, MappingProxyType({"04": 0.97, "05": 4.60, "07": 2.36})),
    PublishedErrors(
        "thesis, stage 1", "the thesis, table 5.2", MappingProxyType({"04": 1.009, "05": 5.26, "07": 2.32})
    ),
    # Its five trials on 07 (2.61, 1.99, 2.03, 1.62, 2.25) have a mean of 2.10; what it prints is repeated here.
    PublishedErrors("thesis, stage 2", "the thesis, table 5.3", MappingProxyType({"04": 1.25, "05": 4.79, "07": 1.97})),
)
"""Stage 1 of the thesis is `dynamic` here, its stage 2 `moving`."""


@dataclass(frozen=True)
class PublishedSegmenter:
    """A network of the thesis on the 200 images of KITTI's semantic-instance training set (5.1.1.1)."""

    name: str
    seconds: float


THESIS_SEGMENTERS = (PublishedSegmenter("Mask R-CNN", 201.96), PublishedSegmenter("SOLOv2", 67.25))
THESIS_GAIN_PERCENT = 10.27
"""by which SOLOv2's average precision of cars is above Mask R-CNN's (figure 5.1)"""
THESIS_MOVING_MEAN_IOU = 0.35
"""of stage 2's two-stream network (5.1.2.1)"""
