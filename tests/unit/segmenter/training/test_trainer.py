# SPDX-License-Identifier: Apache-2.0
"""The loop on painted boxes: it learns, and going on after an interruption is as if there had been none."""

from dataclasses import replace
from pathlib import Path

import pytest
import torch

from services.runtime.errors import InputError
from services.segmenter.solov2.backbones import BACKBONES
from services.segmenter.training.learning_rate import learning_rate
from services.segmenter.training.trainer import STATE_NAME, StepReport, Trainer, TrainingOptions
from tests.unit.segmenter.training.painted_samples import PaintedSamples

CPU = torch.device("cpu")
OPTIONS = TrainingOptions(
    variant="solov2-light_r18",
    categories=("a", "b"),
    sizes=((96, 64), (64, 96)),
    steps=4,
    batch=2,
    warm_up=1,
    cool_down=2,
)


def _trained(folder: Path, *stops: int) -> tuple[Trainer, list[StepReport]]:
    reports: list[StepReport] = []
    for stop in stops:
        trainer = Trainer(OPTIONS, PaintedSamples(), folder, CPU)
        trainer.run(stop, reports.append)
    return trainer, reports


def test_a_resumed_training_ends_in_the_same_weights(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    whole, whole_reports = _trained(tmp_path / "one", 4)
    resumed, resumed_reports = _trained(tmp_path / "two", 2, 4)
    assert [report.step for report in resumed_reports] == [1, 2, 3, 4]
    assert resumed_reports == whole_reports
    for one, two in zip(whole.averaged_network().parameters(), resumed.averaged_network().parameters(), strict=True):
        assert torch.equal(one, two)


def test_a_state_of_other_options_or_cut_off_is_refused(tmp_path: Path) -> None:
    _trained(tmp_path, 1)
    other = replace(OPTIONS, variant="solov2-compact_lite0")
    with pytest.raises(InputError, match=r"was trained with variant solov2-light_r18, expected solov2-compact_lite0"):
        Trainer(other, PaintedSamples(), tmp_path, CPU)
    state = tmp_path / STATE_NAME
    state.write_bytes(state.read_bytes()[:5000])
    with pytest.raises(InputError, match=r"training\.pt: not the whole state of a training"):
        Trainer(OPTIONS, PaintedSamples(), tmp_path, CPU)


def test_a_learned_backbone_keeps_its_early_part_and_its_statistics(tmp_path: Path) -> None:
    options = replace(OPTIONS, variant="solov2-compact_lite0")
    torch.manual_seed(1)
    begun = BACKBONES["efficientnet-lite0"]().state_dict()
    trainer = Trainer(options, PaintedSamples(), tmp_path, CPU, backbone=begun)
    trainer.run(3, lambda report: None)
    learned = trainer.averaged_network().backbone.state_dict()
    changed = {name for name, value in learned.items() if not torch.equal(value, begun[name])}
    assert not any(name.startswith(("stem", "stages.0", "stages.1")) for name in changed)
    assert not any("running" in name for name in changed)
    assert "stages.6.0.project.conv.weight" in changed
    with pytest.raises(InputError, match=r"was trained with backbone learned, expected random"):
        Trainer(options, PaintedSamples(), tmp_path, CPU)
    resumed = Trainer(options, PaintedSamples(), tmp_path, CPU, backbone=begun)
    resumed.run(4, lambda report: None)
    assert torch.equal(resumed.averaged_network().backbone.stem.conv.weight, begun["stem.conv.weight"])


def test_a_training_can_be_made_longer(tmp_path: Path) -> None:
    _trained(tmp_path, 2)
    longer = Trainer(replace(OPTIONS, steps=9, batch=1), PaintedSamples(), tmp_path, CPU)
    reports: list[StepReport] = []
    longer.run(4, reports.append)
    assert [report.step for report in reports] == [3, 4]
    assert reports[-1].learning_rate == OPTIONS.peak_learning_rate


def test_the_rate_warms_up_stays_and_falls() -> None:
    rates = [learning_rate(step, 100, peak=1.0, warm_up=10, cool_down=20) for step in range(100)]
    assert rates[0] == pytest.approx(0.1)
    assert rates[9:80] == pytest.approx([1.0] * 71)
    assert rates[80:] == sorted(rates[80:], reverse=True)
    assert rates[-1] < 0.02
