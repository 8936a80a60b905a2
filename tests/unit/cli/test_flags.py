# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

from services.cli.flags import merge_overrides, parse_settings, resolve_config
from services.runtime.errors import InputError


def test_settings_are_read_as_toml_else_as_text() -> None:
    assert parse_settings(["slam.stage=base", "delivery.window = 4", "camera.stereo=false", "camera.input=a=b"]) == {
        "slam": {"stage": "base"},
        "delivery": {"window": 4},
        "camera": {"stereo": False, "input": "a=b"},
    }


@pytest.mark.parametrize("setting", ["slam", "slam=1", "slam.stage", ".stage=base", "slam.=base", "a.b.c=1", ""])
def test_a_setting_of_another_form_is_refused(setting: str) -> None:
    with pytest.raises(InputError, match=r"expected SECTION\.FIELD=VALUE"):
        parse_settings([setting])


def test_flags_not_given_leave_what_others_say() -> None:
    merged = merge_overrides({"slam": {"stage": "base"}}, {"slam": {"stage": None}, "camera": {"input": "x"}})
    assert merged == {"slam": {"stage": "base"}, "camera": {"input": "x"}}


def test_file_environment_settings_and_flags_each_win_over_the_one_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "c.toml"
    file.write_text('[slam]\nstage = "base"\nfeatures = 500\nseed = 5\n[delivery]\nwindow = 3\n')
    monkeypatch.setenv("KINEMAP_SLAM__FEATURES", "600")
    monkeypatch.setenv("KINEMAP_SLAM__SEED", "6")
    config = resolve_config(file, ["slam.seed=7"], {"slam": {"stage": "dynamic"}})
    assert (config.slam.stage, config.slam.features, config.slam.seed) == ("dynamic", 600, 7)
    assert config.delivery.window == 3


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        (["slam.stage=parked"], r"slam\.stage = 'parked'"),
        (["slam.stages=base"], r"slam\.stages = 'base'"),
        (["nowhere.stage=base"], "nowhere"),
        (["delivery.window=nan"], r"delivery\.window"),
    ],
)
def test_a_value_that_cannot_be_is_one_line(settings: list[str], expected: str) -> None:
    with pytest.raises(InputError, match=expected) as raised:
        resolve_config(None, settings, {})
    assert "\n" not in str(raised.value)
