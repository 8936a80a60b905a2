# SPDX-License-Identifier: Apache-2.0
"""The loop on painted boxes: it learns, and going on after an interruption is as if there had been none."""

from pathlib import Path

import pytest
import torch

from services.runtime.errors import InputError
from services.segmenter.training.learning_rate import learning_rate
from services.segmenter.training.trainer import STATE_NAME, StepReport, Trainer, TrainingOptions
from tests.unit.segmenter.training.painted_samples import PaintedSamples

CPU = torch.device("cpu")
OPTIONS = TrainingOptions(categories=("a", "b"), size=(96, 64), steps=4, batch=2, warm_up=1)


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
    other = TrainingOptions(categories=("a", "b"), size=(96, 64), steps=5, batch=2, warm_up=1)
    with pytest.raises(InputError, match=r"was trained with steps 4, expected 5"):
        Trainer(other, PaintedSamples(), tmp_path, CPU)
    state = tmp_path / STATE_NAME
    state.write_bytes(state.read_bytes()[:5000])
    with pytest.raises(InputError, match=r"training\.pt: not the whole state of a training"):
        Trainer(OPTIONS, PaintedSamples(), tmp_path, CPU)


def test_the_rate_warms_up_and_falls() -> None:
    rates = [learning_rate(step, 100, peak=1.0, warm_up=10) for step in range(100)]
    assert rates[0] == pytest.approx(0.1)
    assert max(rates) == pytest.approx(1.0)
    assert rates[10:] == sorted(rates[10:], reverse=True)
    assert rates[-1] < 0.02
