# SPDX-License-Identifier: Apache-2.0
"""The loop: batches in, a network out, resumable at every save."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import torch
from torch import nn

from services.segmenter.processor import multiplies_bfloat16
from services.segmenter.solov2.backbones import early_part
from services.segmenter.solov2.efficientnet_lite import EfficientNetLite
from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS
from services.segmenter.training.averaged_weights import AveragedWeights
from services.segmenter.training.batches import Augmentation, Augmentations, Batch, BatchOptions, batches
from services.segmenter.training.learning_rate import learning_rate
from services.segmenter.training.losses import segmentation_loss
from services.segmenter.training.sample import Samples
from services.segmenter.training.training_state import TrainingState, load_training_state

_MAX_GRADIENT = 10.0
_LEARNED_BACKBONE_RATE = 0.3
"""of the learning rate, for a backbone that was learned before"""
STATE_NAME = "training.pt"


Precision = Literal["auto", "fp32", "fp16", "bf16"]


@dataclass(frozen=True)
class TrainingOptions:
    """What decides the outcome; the same options, samples and kind of machine give the same network.

    All but the variant and the categories may change when a training goes on.
    """

    variant: str = "solov2-compact_lite0"
    categories: tuple[str, ...] = ()
    sizes: tuple[tuple[int, int], ...] = ((448, 224),)
    """(width, height) of a training image, multiples of 32: each batch has the one that is most like its images"""
    steps: int = 20_000
    batch: int = 16
    peak_learning_rate: float = 4e-4
    weight_decay: float = 0.05
    warm_up: int = 1000
    cool_down: int = 4000
    seed: int = 0
    precision: Precision = "auto"

    @property
    def identity(self) -> dict[str, Any]:
        """What must be the same when a training goes on."""
        return {"variant": self.variant, "categories": list(self.categories)}


@dataclass(frozen=True)
class StepReport:
    """One step's losses."""

    step: int
    category_loss: float
    mask_loss: float
    learning_rate: float


@dataclass
class Trainer:
    """Trains in `folder`, where its state lies between two calls of `run`."""

    options: TrainingOptions
    samples: Samples
    folder: Path
    device: torch.device
    workers: int = 0
    start_from: dict[str, torch.Tensor] | None = None
    """weights to begin with; random otherwise"""
    backbone: dict[str, torch.Tensor] | None = None
    """its weights, learned at ImageNet: what they know is kept, all but the finest maps' part adapts slowly"""
    augmentation: Augmentation | None = None
    """all of Augmentations when not given"""
    curves: dict[str, list[list[float]]] = field(default_factory=dict)
    """by name, [step, value] each: what is drawn"""

    def __post_init__(self) -> None:
        torch.manual_seed(self.options.seed)
        network = SoloV2(VARIANTS[self.options.variant], len(self.options.categories))
        _initialize(network)
        if self.start_from is not None:
            network.load_state_dict(self.start_from)
        if self.backbone is not None:
            network.backbone.load_state_dict(self.backbone)
            for part in early_part(network.backbone):
                part.requires_grad_(False)
        self._network = network.to(self.device).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._average = AveragedWeights(self._network)
        self._optimizer = torch.optim.AdamW(
            _parameter_groups(
                self._network, self.options.weight_decay, 1.0 if self.backbone is None else _LEARNED_BACKBONE_RATE
            )
        )
        # bfloat16 needs no scaling; half precision of older cards does
        self._dtype = _mixed_precision(self.device, self.options.precision)
        self._scaler = torch.amp.GradScaler(self.device.type, enabled=self._dtype == torch.float16)
        self.step = 0
        state_path = self.folder / STATE_NAME
        if state_path.is_file():
            self._restore(load_training_state(state_path, self._settings))

    def run(self, until: int, report: Callable[[StepReport], None]) -> None:
        """Train up to step `until`, then write the state."""
        self._network.train()
        if self.backbone is not None:
            # a few sections of streets say less about means and deviations than ImageNet
            self._network.backbone.eval()
        for batch in self._batches(until):
            report(self._train(batch.to(self.device)))
        self._state().save(self.folder / STATE_NAME)

    def averaged_network(self) -> SoloV2:
        """A copy for use, in evaluation mode."""
        network = SoloV2(VARIANTS[self.options.variant], len(self.options.categories)).to(self.device)
        network.load_state_dict(self._average.state())
        return network.eval()

    def _batches(self, until: int) -> Iterator[Batch]:
        variant = VARIANTS[self.options.variant]
        steps = (self.step, until)
        options = BatchOptions(self.options.batch, steps, self.options.sizes, self.options.seed, self.workers)
        yield from batches(self.samples, self.augmentation or Augmentations(), variant, options)

    def _train(self, batch: Batch) -> StepReport:
        options = self.options
        rate = learning_rate(
            self.step,
            options.steps,
            peak=options.peak_learning_rate,
            warm_up=options.warm_up,
            cool_down=options.cool_down,
        )
        for group in self._optimizer.param_groups:
            group["lr"] = rate * group["share"]
        self._optimizer.zero_grad(set_to_none=True)
        images = batch.images.contiguous(memory_format=torch.channels_last)
        with torch.autocast(self.device.type, self._dtype, enabled=self._dtype != torch.float32):
            output = self._output(images)
            loss = segmentation_loss(output, batch.targets)
        self._scaler.scale(loss.total).backward()  # type: ignore[no-untyped-call]
        self._scaler.unscale_(self._optimizer)
        nn.utils.clip_grad_norm_(self._network.parameters(), _MAX_GRADIENT)
        self._scaler.step(self._optimizer)
        self._scaler.update()
        self._average.update(self._network)
        self.step += 1
        return StepReport(self.step, loss.category.item(), loss.mask.item(), rate)

    def _output(self, images: torch.Tensor) -> HeadOutput:
        # the gradient of convolutions of one filter a channel takes twice as long in bfloat16 on a CPU
        slow_in_16_bits = self.device.type == "cpu" and isinstance(self._network.backbone, EfficientNetLite)
        with torch.autocast(
            self.device.type, self._dtype, enabled=torch.is_autocast_enabled(self.device.type) and not slow_in_16_bits
        ):
            maps = self._network.backbone(images)
        output: HeadOutput = self._network.from_maps(maps)
        return output

    def _state(self) -> TrainingState:
        return TrainingState(
            self.step,
            self._settings,
            self._network.state_dict(),
            self._average.state(),
            self._average.updates,
            self._optimizer.state_dict(),
            self._scaler.state_dict(),
            self.curves,
        )

    @property
    def _settings(self) -> dict[str, Any]:
        return {**self.options.identity, "backbone": "random" if self.backbone is None else "learned"}

    def _restore(self, state: TrainingState) -> None:
        self.step = state.step
        self._network.load_state_dict(state.network)
        self._average.restore(state.average, state.average_updates)
        self._optimizer.load_state_dict(state.optimizer)
        if self._scaler.is_enabled():
            self._scaler.load_state_dict(state.scaler)
        self.curves = state.curves


def _initialize(network: SoloV2) -> None:
    """He's initialisation; the category branch begins by saying one in a hundred (Lin et al., ICCV 2017)."""
    for module in network.modules():
        if isinstance(module, nn.Conv2d):
            nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")
            if module.bias is not None:
                nn.init.zeros_(module.bias)
    for module in (network.mask_head.conv_cls, network.mask_head.conv_kernel):
        nn.init.normal_(module.weight, std=0.01)
    if network.mask_head.conv_cls.bias is not None:
        nn.init.constant_(network.mask_head.conv_cls.bias, -4.595)  # log(0.01 / 0.99)


def _parameter_groups(network: SoloV2, weight_decay: float, backbone_share: float) -> list[dict[str, Any]]:
    """Normalisations and biases are not decayed; `backbone_share`: of the learning rate."""
    groups = []
    for part, share in ((network.backbone, backbone_share), (network.neck, 1.0), (network.mask_head, 1.0)):
        learned = [value for value in part.parameters() if value.requires_grad]
        decayed = [value for value in learned if value.ndim > 1]
        others = [value for value in learned if value.ndim <= 1]
        groups.append({"params": decayed, "weight_decay": weight_decay, "share": share})
        groups.append({"params": others, "weight_decay": 0.0, "share": share})
    return groups


def _mixed_precision(device: torch.device, precision: Precision) -> torch.dtype:
    """What products are computed in; sums, losses and weights keep 32 bits."""
    if precision != "auto":
        return {"fp32": torch.float32, "fp16": torch.float16, "bf16": torch.bfloat16}[precision]
    if device.type != "cuda":
        return torch.bfloat16 if device.type == "cpu" and multiplies_bfloat16() else torch.float32
    return torch.bfloat16 if torch.cuda.is_bf16_supported() else torch.float16
