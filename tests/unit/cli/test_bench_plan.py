# SPDX-License-Identifier: Apache-2.0
"""Which runs a benchmark is made of."""

from pathlib import Path

import pytest

from services.cli.bench.plan import (
    SIMULATOR,
    BenchRequest,
    Variant,
    parse_seeds,
    parse_variant,
    plan_runs,
    stage_variants,
)
from services.runtime.errors import InputError

STAGES = stage_variants("base,moving")


def test_stages_and_seeds_make_runs_that_can_be_compared_one_after_the_other() -> None:
    plan = plan_runs(BenchRequest(variants=STAGES, seeds=(7, 13)))
    assert [str(run.folder) for run in plan] == [
        "simulator/base/seed-7",
        "simulator/moving/seed-7",
        "simulator/base/seed-13",
        "simulator/moving/seed-13",
    ]
    chosen = [(run.configuration["slam"]["stage"], run.configuration["simulator"]["seed"]) for run in plan]
    assert chosen == [("base", 7), ("moving", 7), ("base", 13), ("moving", 13)]


def test_a_repeat_has_seeds_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "03").mkdir()
    request = BenchRequest((str(tmp_path / "03"),), STAGES[:1], repeat=3, settings=("slam.seed=5", "motion.seed=9"))
    plan = plan_runs(request)
    assert [str(run.folder) for run in plan] == [f"03/base/repeat-{number}" for number in (1, 2, 3)]
    assert [run.configuration["slam"]["seed"] for run in plan] == [5, 6, 7]
    assert [run.configuration["motion"]["seed"] for run in plan] == [9, 10, 11]
    assert len({run.fingerprint for run in plan}) == 3


def test_seeds_are_the_simulators_and_repeats_everybodys(tmp_path: Path) -> None:
    request = BenchRequest((SIMULATOR, str(tmp_path)), STAGES[:1], seeds=(7, 13), repeat=2)
    trials = [run.trial for run in plan_runs(request)]
    assert trials == [
        *("seed-7-repeat-1", "seed-7-repeat-2", "seed-13-repeat-1", "seed-13-repeat-2"),
        *("repeat-1", "repeat-2"),
    ]


def test_settings_reach_every_run_and_a_variant_wins_over_them() -> None:
    request = BenchRequest(
        variants=(*STAGES, parse_variant("few:slam.features=500,motion.flow_preset=medium")),
        settings=("slam.features=900", "motion.flow_preset=ultrafast"),
        frames=40,
    )
    configurations = [run.configuration for run in plan_runs(request)]
    assert [each["slam"]["features"] for each in configurations] == [900, 900, 500]
    assert [each["motion"]["flow_preset"] for each in configurations] == ["ultrafast", "ultrafast", "medium"]
    assert [each["slam"]["stage"] for each in configurations] == ["base", "moving", "moving"]
    assert {each["camera"]["max_frames"] for each in configurations} == {40}


def test_a_variant_may_hold_a_list() -> None:
    variant = parse_variant('cars:segmenter.categories=["car","bus"], slam.stage=base')
    assert variant == Variant("cars", {"segmenter": {"categories": ["car", "bus"]}, "slam": {"stage": "base"}})


def test_the_fingerprint_is_of_what_a_run_depends_on(monkeypatch: pytest.MonkeyPatch) -> None:
    request = BenchRequest(variants=STAGES[:1])
    before = plan_runs(request)[0].fingerprint
    assert plan_runs(BenchRequest(variants=STAGES[:1], settings=("mapstore.http_port=9",)))[0].fingerprint == before
    assert plan_runs(BenchRequest(variants=STAGES[:1], frames=3))[0].fingerprint != before
    monkeypatch.setenv("KINEMAP_SLAM__FEATURES", "777")
    assert plan_runs(request)[0].fingerprint != before
    # A stage is asked for by name: no environment changes what it means.
    monkeypatch.setenv("KINEMAP_SLAM__STAGE", "dynamic")
    assert plan_runs(request)[0].configuration["slam"]["stage"] == "base"


def test_inputs_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    inputs = [tmp_path / "grey" / "03", tmp_path / "colour" / "03", tmp_path / "a b"]
    for folder in inputs:
        folder.mkdir(parents=True)
    plan = plan_runs(BenchRequest(tuple(map(str, inputs)), STAGES[:1]))
    assert [run.input for run in plan] == ["03", "colour-03", "a-b"]
    assert [run.configuration["camera"]["input"] for run in plan] == [str(folder.resolve()) for folder in inputs]


@pytest.mark.parametrize("text", ["a", "a:", "a:slam", ":slam.stage=base", "a/b:slam.stage=base", "..:slam.stage=base"])
def test_what_is_no_variant(text: str) -> None:
    with pytest.raises(InputError, match=r"--variant .*expected"):
        parse_variant(text)


@pytest.mark.parametrize("text", ["", "7,", "7,7", "7,07", "-1", "1.5", "a"])
def test_what_are_no_seeds(text: str) -> None:
    with pytest.raises(InputError, match="expected different whole numbers"):
        parse_seeds(text)


@pytest.mark.parametrize(
    ("request_", "part"),
    [
        (BenchRequest(variants=STAGES + STAGES), "expected different names"),
        (BenchRequest(("x",), STAGES, seeds=(7,)), "--seeds 7: of the simulator, which is no input here"),
        (BenchRequest((SIMULATOR, SIMULATOR), STAGES), "given twice"),
        (BenchRequest(variants=(Variant("a", {"slam": {"stage": "parked"}}),)), "slam.stage = 'parked'"),
        (BenchRequest(variants=STAGES, settings=("slam.no=1",)), "slam.no"),
    ],
)
def test_a_request_that_cannot_be_met(request_: BenchRequest, part: str) -> None:
    with pytest.raises(InputError, match=part):
        plan_runs(request_)


def test_a_stage_that_there_is_not() -> None:
    with pytest.raises(InputError, match="'parked' is no stage, expected some of base,dynamic,moving"):
        stage_variants("base,parked")
