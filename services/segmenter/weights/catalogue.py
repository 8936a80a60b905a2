# SPDX-License-Identifier: Apache-2.0
"""The public checkpoints that can be pulled by name: mmdetection's (Apache-2.0), trained on COCO 2017."""

from dataclasses import dataclass
from typing import Final

from services.runtime.errors import InputError

_ZOO = "https://download.openmmlab.com/mmdetection/v2.0"


@dataclass(frozen=True)
class PublicModel:
    """A checkpoint of the model zoo."""

    name: str
    """of its configuration in mmdetection 3.x"""
    variant: str
    """of networks.NAMES"""
    folder: str
    file_name: str
    mask_ap: float
    """published, in percent, COCO val 2017"""
    family: str = "solov2"

    @property
    def url(self) -> str:
        """Where it is downloaded from."""
        return f"{_ZOO}/{self.family}/{self.folder}/{self.file_name}"

    @property
    def sha256_prefix(self) -> str:
        """The first eight hex digits, which publishers write into the name."""
        return sha256_prefix_of(self.file_name) or ""


def _model(name: str, variant: str, folder: str, suffix: str, mask_ap: float) -> PublicModel:
    return PublicModel(name, variant, folder, f"{folder}_{suffix}.pth", mask_ap)


PUBLIC_MODELS: Final = (
    _model(
        "solov2-light_r18_fpn_ms-3x_coco",
        "solov2-light_r18",
        "solov2_light_r18_fpn_3x_coco",
        "20220511_083717-75fa355b",
        29.7,
    ),
    _model(
        "solov2-light_r34_fpn_ms-3x_coco",
        "solov2-light_r34",
        "solov2_light_r34_fpn_3x_coco",
        "20220511_091839-e51659d3",
        31.9,
    ),
    _model(
        "solov2-light_r50_fpn_ms-3x_coco",
        "solov2-light_r50",
        "solov2_light_r50_fpn_3x_coco",
        "20220512_165256-c93a6074",
        33.7,
    ),
    _model("solov2_r50_fpn_1x_coco", "solov2_r50", "solov2_r50_fpn_1x_coco", "20220512_125858-a357fa23", 34.8),
    _model("solov2_r50_fpn_ms-3x_coco", "solov2_r50", "solov2_r50_fpn_3x_coco", "20220512_125856-fed092d4", 37.5),
    _model("solov2_r101_fpn_ms-3x_coco", "solov2_r101", "solov2_r101_fpn_3x_coco", "20220511_095119-c559a076", 39.1),
    PublicModel(
        "mask-rcnn_r50_fpn_1x_coco",
        "mask-rcnn_r50",
        "mask_rcnn_r50_fpn_1x_coco",
        "mask_rcnn_r50_fpn_1x_coco_20200205-d4b0c5d6.pth",
        34.7,
        "mask_rcnn",
    ),
)
"""SOLOv2 first, the fastest of it first; Mask R-CNN is what the thesis compares it with."""


def public_model(name: str) -> PublicModel:
    """The model of this name, of this checkpoint file, or the best of this variant. Raises InputError for others."""
    for model in PUBLIC_MODELS:
        if name in (model.name, model.file_name):
            return model
    of_variant = [model for model in PUBLIC_MODELS if model.variant == name]
    if of_variant:
        return max(of_variant, key=lambda model: model.mask_ap)
    why = "needs deformable convolutions, which are not built here" if "dcn" in name else "is no known model"
    raise InputError(f"weights {name}: {why}, expected one of {', '.join(model.name for model in PUBLIC_MODELS)}")


def sha256_prefix_of(file_name: str) -> str | None:
    """The eight hex digits that a published file's name ends in; None where it has none."""
    stem, _, suffix = file_name.rpartition(".")
    digits = stem.rpartition("-")[2]
    is_prefix = suffix == "pth" and len(digits) == 8 and all(digit in "0123456789abcdef" for digit in digits)
    return digits if is_prefix else None
