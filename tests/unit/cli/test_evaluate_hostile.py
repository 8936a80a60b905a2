# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate` against input that means harm: one line, exit code 2, and no input written over."""

import builtins
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.cli.app import main
from services.cli.evaluate.output import print_table
from services.evaluation.run.comparison import ComparisonRow
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index

Refused = Callable[..., str]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NO_COLOR", "1")
    _parabola("truth.tum")
    _parabola("estimate.tum", 0.01)


@pytest.fixture
def ended(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Runs `kinemap evaluate ARGUMENTS`: code, standard output, standard error."""

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["kinemap", "evaluate", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        return int(end.value.code or 0), *capsys.readouterr()

    return run


@pytest.fixture
def refused(ended: Callable[..., tuple[int, str, str]]) -> Refused:
    """Runs a command that must be refused in one line, and gives that line."""

    def run(*arguments: str) -> str:
        code, _, err = ended(*arguments)
        assert code == 2, err
        assert err.startswith("kinemap: error: "), err
        assert err.count("\n") == 1, err
        return err

    return run


def _parabola(name: str, bend: float = 0.0, head: str = "") -> None:
    rows = [f"{0.1 * i:.1f} {i} {0.1 * i * i + bend * i} 0 0 0 0 1\n" for i in range(20)]
    Path(name).write_text(head + "".join(rows), encoding="utf-8")


def _labels(name: str, category: str = "car") -> None:
    Path(name).mkdir()
    labels = np.zeros((60, 80), dtype=np.uint8)
    labels[5:55, 5:60] = 1
    write_label_image(Path(name) / "0.png", labels)
    write_label_index(Path(name), {"0": [LabelledInstance(1, category, 0.9, moving=True)]})


def _boxes(name: str, last_frame: int = 3) -> None:
    rows = [f"{frame} 1 Car 0 0 0 10 10 60 60 1 1 1 0 0 9 0\n" for frame in (0, 1, 2, last_frame)]
    Path(name).write_text("".join(rows))


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ("--rate 1e-300", "rate 1e-300 Hz, expected 0.001 to 10000"),
        ("--rate 1e12", "rate 1e+12 Hz, expected 0.001 to 10000"),
        ("--delta 1000000000000000000000000000", "expected 1 to 1000000000"),
        ("--max-difference 1e300", "--max-difference 1e+300: expected seconds"),
        ("--times none.txt", "--times none.txt: no such file"),
        ("--json truth.tum", "--json truth.tum: is there already and belongs to the input truth.tum"),
        ("--json estimate.tum", "belongs to the input estimate.tum"),
        ("--json .", "--json .: is a folder"),
        ("--plots /proc", "/proc/trajectory.png: cannot be written"),
        ("--plots " + "a" * 5000, "File name too long"),
    ],
)
def test_options_of_trajectories(refused: Refused, options: str, expected: str) -> None:
    before = Path("truth.tum").read_bytes(), Path("estimate.tum").read_bytes()
    assert expected in refused("trajectory", "estimate.tum", "--truth", "truth.tum", *options.split())
    assert (Path("truth.tum").read_bytes(), Path("estimate.tum").read_bytes()) == before


@pytest.mark.parametrize("subcommand", [[], ["run"], ["masks"], ["moving"], ["flow"], ["tracking"], ["density"]])
def test_a_name_that_no_file_can_have(refused: Refused, subcommand: list[str]) -> None:
    if subcommand == ["moving"]:
        _labels("true")
    truth = (
        [] if subcommand in (["run"], ["density"]) else ["--truth", "true" if Path("true").exists() else "truth.tum"]
    )
    assert "aaaa" in refused(*subcommand, "a" * 5000, *truth)


def test_a_position_whose_square_overflows(refused: Refused) -> None:
    rows = Path("estimate.tum").read_text().splitlines()
    Path("far.tum").write_text("\n".join([*rows, "9.0 1e200 0 0 0 0 0 1"]))
    assert "far.tum: pose 21 of 21 is at 1e+200 m, expected at most 1e+09" in refused(
        "trajectory", "far.tum", "--truth", "truth.tum"
    )


def test_a_byte_order_mark_is_no_number(ended: Callable[..., tuple[int, str, str]]) -> None:
    _parabola("marked.tum", 0.01, head="\ufeff# t x y z qx qy qz qw\n")
    _, plain, _ = ended("trajectory", "estimate.tum", "--truth", "truth.tum")
    code, marked, _ = ended("trajectory", "marked.tum", "--truth", "truth.tum")
    assert code == 0
    assert [line.split()[-2:] for line in marked.splitlines()[1:]] == [
        line.split()[-2:] for line in plain.splitlines()[1:]
    ]


@pytest.mark.parametrize("name", ["$x^$", "_hidden", "名前", "x" * 200, ":smile:", "[red]"])
def test_pictures_and_tables_take_any_name_literally(
    ended: Callable[..., tuple[int, str, str]], name: str, recwarn: pytest.WarningsRecorder
) -> None:
    _parabola(f"{name}.tum", 0.01)
    code, out, err = ended("trajectory", f"{name}.tum", "--truth", "truth.tum", "--plots", "pictures")
    assert (code, err) == (0, "")
    assert name in out.replace("\n", "").replace(" ", "")
    assert len(list(Path("pictures").glob("*.png"))) == 4
    assert not recwarn.list


def test_a_category_can_be_called_anything(ended: Callable[..., tuple[int, str, str]]) -> None:
    for place, category in enumerate(("$x^$", "_a", "")):
        _labels(f"truth{place}", category)
        code, _, err = ended("masks", f"truth{place}", "--truth", f"truth{place}", "--plots", f"pictures{place}")
        assert (code, err) == (0, "")


def test_a_frame_far_away_costs_no_time(ended: Callable[..., tuple[int, str, str]]) -> None:
    _boxes("near.txt")
    _boxes("far.txt", 10**15)
    tables = [ended("tracking", name, "--truth", name) for name in ("near.txt", "far.txt")]
    assert tables[0][0] == 0
    assert tables[0] == tables[1]


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ("0 1 Car", f"0 {10**30} Car", "of 64 bits"),
        ("0 1 Car", "0 1_0 Car", "id '1_0', expected a whole number"),
        ("10 10 60 60", "-1e308 -1e308 1e308 1e308", "expected pixels up to 1e+06"),
    ],
)
def test_numbers_of_boxes(refused: Refused, before: str, after: str, expected: str) -> None:
    _boxes("truth.txt")
    Path("found.txt").write_text(Path("truth.txt").read_text().replace(before, after, 1))
    assert expected in refused("tracking", "found.txt", "--truth", "truth.txt")


@pytest.mark.parametrize(
    ("index", "expected"),
    [
        ('{"0": [], "0": []}', 'the name "0" stands twice'),
        ('{"0": [{"id": ' + "9" * 5000 + ', "category": "car"}]}', "not JSON"),
        ('{"a\\u0000b": [{"id": 1, "category": "car", "moving": true}]}', "no name of a file"),
    ],
)
@pytest.mark.parametrize("subcommand", ["masks", "moving", "tracking"])
def test_indices_of_label_images(refused: Refused, subcommand: str, index: str, expected: str) -> None:
    _labels("found")
    _labels("true")
    Path("true/instances.json").write_text(index)
    found = "true" if "u0000" in index else "found"
    assert expected in refused(subcommand, found, "--truth", "true")


def test_no_input_is_written_over(refused: Refused) -> None:
    _labels("true")
    before = Path("true/instances.json").read_bytes()
    assert "belongs to the input true" in refused("masks", "true", "--truth", "true", "--json", "true/instances.json")
    assert "--plots true: is an input" in refused("moving", "true", "--truth", "true", "--plots", "true")
    assert Path("true/instances.json").read_bytes() == before


def test_a_package_that_is_missing_is_named(refused: Refused, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without_matplotlib(name: str, *given: Any, **named: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ModuleNotFoundError(f"No module named '{name}'", name="matplotlib")
        return real(name, *given, **named)

    for module in [m for m in sys.modules if m.startswith(("matplotlib", "services.evaluation.trajectory.plots"))]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.delitem(sys.modules, "services.evaluation.pictures.figure", raising=False)
    monkeypatch.setattr(builtins, "__import__", without_matplotlib)
    line = refused("trajectory", "estimate.tum", "--truth", "truth.tum", "--plots", "pictures")
    assert "matplotlib is not installed" in line


@pytest.mark.parametrize("broken", [{"version": 1}, {"frames": None}, {"ate": {"final": 3}}, {"stage_ms": {"a": {}}}])
def test_reports_that_are_not_whole(refused: Refused, broken: dict[str, Any]) -> None:
    whole = {
        **{"version": 1, "failure": "", "frames": {"in": 1, "expected": 1, "tracked": 1}, "ate": None},
        **{"landmarks": {}, "density_frames": {}, "moving_flag": None, "services": {}, "frames_per_s": None},
    }
    for name, report in (("a", whole), ("b", broken if "version" in broken else whole | broken)):
        Path(name).mkdir()
        Path(name, "report.json").write_text(json.dumps(report))
    assert "b/report.json: not a whole report" in refused("run", "a", "b")


def test_columns_that_do_not_fit_stand_in_tables_of_their_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("services.cli.evaluate.output._LOG_WIDTH", 60)
    names = [f"class-{number}" for number in range(12)]
    print_table(names, [ComparisonRow("a measure of twenty-six c.", tuple(f"{n}.000" for n in range(12)))])
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert max(map(len, lines)) <= 60
    assert [name for line in lines[::3] for name in line.split()] == names
    assert lines[1].split()[-3:] == ["0.000", "1.000", "2.000"]
