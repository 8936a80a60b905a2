# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate` as a user types it: what a path alone means, tables, files, and one line for nonsense."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from services.cli.evaluate.app import subcommand_for
from tests.command_line import Ended, run_kinemap

Kinemap = Callable[..., Ended]


@pytest.fixture
def kinemap(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Kinemap:
    """Runs `kinemap evaluate ARGUMENTS` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: str | Path) -> Ended:
        return run_kinemap(monkeypatch, capsys, "evaluate", *arguments)

    return run


def _one_line(ended: Ended, *parts: str) -> None:
    assert ended.code == 2, ended
    assert ended.err.startswith("kinemap: error: "), ended.err
    assert ended.err.count("\n") == 1, ended.err
    for part in parts:
        assert part in ended.err, ended.err


def _parabola(path: str, skip: int = 0, count: int = 10, later_s: float = 0.0) -> Path:
    rows = [f"{0.1 * i + later_s:.1f} {i} 0 {i * i} 0 0 0 1\n" for i in range(skip, count)]
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text("".join(rows))
    return Path(path)


def test_every_subcommand_explains_itself(kinemap: Kinemap) -> None:
    for subcommand in ("run", "trajectory", "density", "map"):
        ended = kinemap(subcommand, "--help")
        assert (ended.code, f"Usage: kinemap evaluate {subcommand}" in ended.out) == (0, True)


def test_a_path_alone_means_what_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("runs").mkdir()
    _parabola("a.tum")
    assert subcommand_for(["runs"]) == "run"
    assert subcommand_for(["--recover", "runs", "a.tum"]) == "run"
    assert subcommand_for(["a.tum", "--truth", "b.tum"]) == "trajectory"
    assert subcommand_for(["--truth", "b.tum", "a.tum"]) == "trajectory"
    assert subcommand_for(["none.tum"]) == "trajectory"


def test_errors_stand_beside_their_coverage_in_table_json_and_pictures(kinemap: Kinemap) -> None:
    truth = _parabola("truth.tum")
    files = (_parabola("a.tum", skip=2), truth, "--truth", truth)
    ended = kinemap("trajectory", *files, "--json", "out/a.json", "--plots", "plots")
    assert ended.code == 0, ended
    assert re.search(r"ATE RMSE \[m\] +0\.000 \(80\.0%\) +0\.000 \(100\.0%\)", ended.out)
    first, second = json.loads(Path("out/a.json").read_text())["estimates"]
    assert (first["name"], first["file"], first["coverage"]) == ("a", "a.tum", pytest.approx(0.8))
    assert first["ate_m"]["rmse"] == pytest.approx(0.0, abs=1e-6)
    assert (second["name"], second["coverage"]) == ("truth", 1.0)
    for name in ("trajectory", "xyz", "error_violin", "error_over_time"):
        assert Path(f"plots/{name}.png").read_bytes().startswith(b"\x89PNG")
    assert kinemap(*files).out == ended.out


def test_folders_of_runs_bring_their_truth_and_share_it(kinemap: Kinemap) -> None:
    for stage in ("base", "moving"):
        _parabola(f"{stage}/trajectory.tum", skip=1)
        _parabola(f"{stage}/ground_truth.tum")
    ended = kinemap("trajectory", "base", "moving")
    assert (ended.code, ended.out.count("(90.0%)") >= 2) == (0, True)
    _parabola("moving/ground_truth.tum", count=9)
    _one_line(kinemap("trajectory", "base", "moving"), "moving/ground_truth.tum: not the same", "runs of one input")
    _one_line(kinemap("trajectory", "base", "base"), "base: given twice")
    Path("empty").mkdir()
    _one_line(kinemap("trajectory", "empty"), "empty: no trajectory.tum here")


def test_a_body_is_brought_to_its_camera(kinemap: Kinemap) -> None:
    # The body turns in place by quarter turns; its camera sits 2 m ahead of it and goes round.
    quarter = ["1,0,0,0", "0.7071068,0,0,0.7071068", "0,0,0,1", "0.7071068,0,0,-0.7071068"]
    Path("data.csv").write_text("#timestamp\n" + "".join(f"{i},0,0,0,{q}\n" for i, q in enumerate(quarter)))
    Path("sensor.yaml").write_text("T_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,2, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n")
    Path("camera.csv").write_text(
        "".join(f"{i},{p},{quarter[i]}\n" for i, p in enumerate(("2,0,0", "0,2,0", "-2,0,0", "0,-2,0")))
    )
    _one_line(kinemap("camera.csv", "--truth", "data.csv"), "true positions are at one place")
    ended = kinemap(
        "camera.csv", "--truth", "data.csv", "--sensor", "sensor.yaml", "--align", "none", "--json", "a.json"
    )
    assert ended.code == 0, ended
    assert json.loads(Path("a.json").read_text())["estimates"][0]["ate_m"]["max"] < 1e-6


def test_kitti_poses_without_times_take_the_rate(kinemap: Kinemap) -> None:
    rows = [f"1 0 0 {i} 0 1 0 0 0 0 1 {i * i}\n" for i in range(20)]
    Path("truth.txt").write_text("".join(rows))
    Path("estimate.txt").write_text("".join(rows[:15]))
    _one_line(kinemap("estimate.txt", "--truth", "truth.txt"), "KITTI poses hold no times, expected --times")
    ended = kinemap("estimate.txt", "--truth", "truth.txt", "--rate", "10")
    assert (ended.code, "15 of 20 frames (75.0%)" in ended.out) == (0, True)


def test_nonsense_trajectories(kinemap: Kinemap) -> None:
    good = _parabola("good.tum")
    Path("empty.tum").write_text("")
    Path("nan.tum").write_text("0.1 nan 0 0 0 0 0 1\n")
    Path("one.tum").write_text("0.1 0 0 0 0 0 0 1\n")
    Path("still.tum").write_text("".join(f"{0.1 * i:.1f} 5 5 5 0 0 0 1\n" for i in range(10)))
    _parabola("late.tum", later_s=100.0)
    for name, part in (
        ("none", "none.tum: no such file"),
        ("empty", "empty.tum: holds no rows"),
        ("nan", "nan.tum:1: tx 'nan', expected a finite number"),
        ("one", "one.tum: 1 poses, expected at least 3"),
        ("late", "0 poses of late.tum (100.000 to 100.900 s) are within 10 ms of good.tum"),
        ("still", "still.tum: all 10 estimated positions are at one place"),
    ):
        _one_line(kinemap(f"{name}.tum", "--truth", good), part)
    _one_line(kinemap(good, "--truth", "still.tum"), "all 10 true positions are at one place: they give no scale")
    _one_line(kinemap("none.tum"), "expected --truth")
    _one_line(kinemap(good, "--truth", good, "--max-difference", "nan"), "--max-difference nan")
    _one_line(kinemap(good, "--truth", good, "--plots", good), "--plots good.tum: is a file, expected a folder")
    _one_line(kinemap(good, "--truth", good, "--sensor", good), "good.tum: holds no T_BS")


def test_only_runs_are_compared(kinemap: Kinemap) -> None:
    Path("runs").mkdir()
    Path("a.tum").write_text("")
    _one_line(kinemap("runs", "a.tum"), "runs/report.json: no such report")
    _one_line(kinemap("run", "runs", "a.tum"), "runs/report.json: no such report")
    _one_line(kinemap("run", "a.tum", "runs"), "a.tum: expected the folders of runs")


def _ply(path: str, *rows: str) -> Path:
    header = (
        f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\nproperty float x\nproperty float y\nproperty float z\n"
    )
    Path(path).write_text(header + "property uchar state\nend_header\n" + "".join(f"{row}\n" for row in rows))
    return Path(path)


def test_a_map_is_aligned_by_its_path_and_held_against_a_surface(kinemap: Kinemap) -> None:
    surface = _ply("surface.ply", "0 1 0 0", "2 1 0 0", "4 1 0 1")
    # The map is half as large as the world, as its path says.
    points = _ply("map.ply", "0 0.5 0 0", "1 0.5 0 0", "2 0.5 0.05 1")
    Path("truth.tum").write_text("".join(f"{i} {i} 0 0 0 0 0 1\n" for i in range(5)))
    Path("path.tum").write_text("".join(f"{i} {i / 2} 0 0 0 0 0 1\n" for i in range(4)))
    aligned = ("--trajectory", "path.tum", "--truth", "truth.tum", "--json", "map.json", "--plots", "plots")
    ended = kinemap("map", points, "--surface", surface, *aligned)
    assert ended.code == 0, ended
    assert "sim3, scale 2, by 4 of 5 poses (80.0%)" in ended.out
    found = json.loads(Path("map.json").read_text())
    assert found["accuracy"]["mean_m"] == pytest.approx(0.1 / 3, abs=1e-6)
    assert (found["label_accuracy"], found["completeness"]["share_near"]) == (1.0, 1.0)
    assert Path("plots/map_error.png").is_file()
    assert Path("plots/map_labels.png").is_file()
    ended = kinemap("map", points, "--surface", surface)
    assert (ended.code, "none: the map is taken to be in the surface's frame" in ended.out) == (0, True)


def test_nonsense_maps(kinemap: Kinemap) -> None:
    points, path = _ply("map.ply", "0 0 0 0"), _parabola("path.tum")
    _one_line(kinemap("map", points), "map.ply: expected --surface with the true surface")
    _one_line(kinemap("map", points, "--surface", "none.ply"), "none.ply: cannot be read (No such file")
    _one_line(kinemap("map", points, "--surface", points, "--truth", path), "expected both or neither")
    _one_line(kinemap("map", _ply("nan.ply", "0 nan 0 0"), "--surface", points), "nan.ply: point 1 of 1 is not finite")
    _one_line(kinemap("map", _ply("empty.ply"), "--surface", points), "empty.ply: no point of what stands")
    _one_line(kinemap("map", points, "--surface", points, "--within", "-3"), "within -3 m, expected a number above 0")
    late = _parabola("late.tum", later_s=50.0)
    aligned = ("--trajectory", late, "--truth", path)
    _one_line(kinemap("map", points, "--surface", points, *aligned), "0 poses of late.tum are within 10 ms of path.tum")
    Path("folder").mkdir()
    _one_line(kinemap("map", "folder"), "folder/map.pcd: cannot be read (No such file")


def test_nonsense_densities(kinemap: Kinemap) -> None:
    _one_line(kinemap("density", "none.mcap"), "none.mcap: no such file")
    Path("folder").mkdir()
    _one_line(kinemap("density", "folder"), "folder: no run here")
    _one_line(kinemap("density", "folder", "--min-height", "nan"), "--min-height nan: expected pixels, 0 or more")
    Path("a.mcap").write_text("no session")
    _one_line(kinemap("density", "a.mcap"), "a.mcap: not an MCAP file")
