# SPDX-License-Identifier: Apache-2.0
"""`kinemap bench` when something is wrong, before anything is run; and the command as a page shows it."""

import sys
from pathlib import Path

import pytest

from services.cli.app import main
from services.cli.bench.command import _command


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--stages", "parked"), ("--stages parked: 'parked' is no stage", "base,dynamic,moving")),
        (("--seeds", "7,x"), ("--seeds 7,x: expected different whole numbers",)),
        (("--variant", "a"), ("--variant a: expected NAME:SECTION.FIELD=VALUE",)),
        (("--variant", "base:slam.features=9", "--stages", "base"), ("variants base,base",)),
        (("--page", "page.md"), ("--page page.md: expected --table",)),
        (("--table", "x"), ("docs/measurements.md: no such page",)),
        (("--table", "x", "--page", "half.md"), ("half.md: expected <!-- x: begin -->",)),
        (("/no/such",), ("/no/such: no such file or folder",)),
        (("empty",), ("empty", "the folder is empty")),
        (("--frames", "0"), ("camera.max_frames = 0",)),
        (("--set", "slam.features=few"), ("slam.features = 'few'",)),
        (("--config", "none.toml"), ("none.toml cannot be read",)),
        (("--out", "half.md"), ("--out half.md: is a file",)),
        (("--out", "."), ("--out .: no benchmark's folder",)),
        (("--out", "a" * 300), ("--out aaa", "cannot be a folder (File name too long)")),
        (("a" * 5000,), ("input aaa", "cannot be opened (File name too long)")),
        (("--stages", ""), ("is no stage",)),
        (("--label", "<!-- x: end -->"), ("--label '<!-- x: end -->': expected one line",)),
        (("--label", "two\nlines"), ("--label 'two\\nlines': expected one line",)),
    ],
)
def test_bad_input_is_one_line_and_starts_nothing(
    arguments: tuple[str, ...],
    parts: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("half.md").write_text("<!-- x: begin -->")
    Path("empty").mkdir()
    monkeypatch.setattr(sys, "argv", ["kinemap", "bench", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    error = capsys.readouterr().err
    assert (ended.value.code, error.count("\n")) == (2, 1), error
    assert error.startswith("kinemap: error: ")
    for part in parts:
        assert part in error
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "half.md"]


def test_the_page_names_no_folder_of_this_machine(tmp_path: Path) -> None:
    options = {
        "stages": None,
        "variant": ["few:slam.features=500", "two words:slam.seed=2"],
        "frames": 40,
        "config": tmp_path / "my.toml",
        "label": "",
    }
    assert _command(["simulator", str(tmp_path / "03")], options) == (
        "kinemap bench simulator 03 --variant few:slam.features=500 --variant 'two words:slam.seed=2'"
        " --frames 40 --config my.toml"
    )
