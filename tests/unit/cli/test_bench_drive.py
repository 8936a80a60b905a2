# SPDX-License-Identifier: Apache-2.0
"""A benchmark on played runs: what is run, what is kept, what is said."""

import io
import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

import services
from services.cli.bench.bench_folder import bench_folder, reserved
from services.cli.bench.child_run import RunEnd, RunningRun
from services.cli.bench.drive import FailedRunsError, InterruptedBenchError, run_bench
from services.cli.bench.kept_runs import _CODE_OF_NO_RUN, KeptRuns
from services.cli.bench.plan import BenchRequest, PlannedRun, plan_runs, stage_variants
from services.cli.bench.results import BenchOutput
from services.cli.bench.schedule import Schedule
from services.evaluation.bench.file import read_bench
from services.runtime.errors import InputError

ATE_M = {"base": 4.0, "moving": 1.0}
PLAN = plan_runs(BenchRequest(variants=stage_variants("base,moving"), seeds=(7, 13)))


class PlayedRun:
    """A run that has ended when it is first looked at, after `looks` looks."""

    def __init__(self, end: RunEnd | BaseException, looks: int = 0) -> None:
        self.stopped = False
        self._end, self._looks = end, looks

    def wait(self, timeout_s: float) -> RunEnd | None:
        self._looks -= 1
        if self._looks >= 0:
            return None
        if isinstance(self._end, BaseException):
            raise self._end
        return self._end

    def share_done(self) -> float:
        return 0.5

    def stop(self) -> None:
        self.stopped = True


class PlayedRunner:
    """Writes the report that a run would; `endings` by a run's name replace a good end."""

    def __init__(self, endings: dict[str, RunEnd | BaseException] | None = None, looks: int = 0) -> None:
        self.started: list[str] = []
        self.runs: list[PlayedRun] = []
        self.coverage: dict[str, float] = {}
        self._endings = endings or {}
        self._looks = looks

    def start(self, run: PlannedRun, folder: Path) -> RunningRun:
        assert not folder.exists()
        self.started.append(run.name)
        folder.mkdir(parents=True)
        end = self._endings.get(run.name, RunEnd("", 12.0))
        if isinstance(end, RunEnd) and not end.failure:
            report = _report(ATE_M[run.variant], self.coverage.get(run.name, 1.0))
            (folder / "report.json").write_text(json.dumps(report))
        self.runs.append(PlayedRun(end, self._looks))
        return self.runs[-1]


def _report(ate_m: float, coverage: float) -> dict[str, Any]:
    return {
        "version": 1,
        "failure": "",
        "frames": {"in": 100, "expected": 100, "tracked": round(100 * coverage)},
        "ate": {"final": {"coverage": coverage, "ate_m": {"rmse": ate_m}}},
        "moving_flag": None,
        "landmarks": {"static": 5},
        "density_frames": {"low": 100},
        "frames_per_s": 8.0,
        "services": {},
    }


class Bench:
    """A benchmark's folder, and what its last use printed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.printed = ""

    def run(self, runner: PlayedRunner, plan: list[PlannedRun] = PLAN, jobs: int = 1, **output: Any) -> None:
        """One use; what it raises comes through."""
        text = io.StringIO()
        given = BenchOutput(**{"folder": self.folder, "page": Path("none.md"), "command": "kinemap bench"} | output)
        try:
            run_bench(plan, given, runner, Console(file=text, width=120, markup=False), jobs)
        finally:
            self.printed = text.getvalue()


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    """A benchmark in a new folder."""
    return Bench(tmp_path / "bench")


def test_all_runs_are_done_and_set_side_by_side(bench: Bench) -> None:
    runner = PlayedRunner()
    bench.run(runner)
    assert runner.started == [run.name for run in PLAN]
    file = read_bench(bench.folder)
    assert [(run.input, run.variant, run.trial) for run in file.runs] == [
        (run.input, run.variant, run.trial) for run in PLAN
    ]
    assert (file.planned, file.runs[0].fingerprint) == (4, PLAN[0].fingerprint)
    assert "simulator base seed-7 (12 s): 100.0% of 100 frames tracked, ATE 4.000 m" in bench.printed
    assert "4.000 [4.000..4.000]" in bench.printed
    assert "0.25 (better in 2 of 2)" in bench.printed


def test_what_went_through_is_not_run_again(bench: Bench) -> None:
    bench.run(PlayedRunner())
    again = PlayedRunner()
    bench.run(again)
    assert again.started == []
    assert "4 of 4 runs are there already" in bench.printed
    assert "0.25 (better in 2 of 2)" in bench.printed
    assert "earlier state" not in bench.printed


def test_more_seeds_cost_only_their_own_runs(bench: Bench) -> None:
    bench.run(PlayedRunner())
    more = plan_runs(BenchRequest(variants=stage_variants("base,moving"), seeds=(7, 13, 14)))
    again = PlayedRunner()
    bench.run(again, more)
    assert again.started == ["simulator base seed-14", "simulator moving seed-14"]
    assert len(read_bench(bench.folder).runs) == 6


def test_a_failed_run_stops_no_other_and_is_run_again(bench: Bench) -> None:
    with pytest.raises(FailedRunsError, match="1 of 4 runs failed") as raised:
        bench.run(PlayedRunner({"simulator moving seed-7": RunEnd("slam: [gone]", 3.0)}))
    assert raised.value.exit_code == 1
    assert bench.printed.count("simulator moving seed-7 failed: slam: [gone]\n") == 1
    assert "0.25 (better in 1 of 1)" in bench.printed
    again = PlayedRunner()
    bench.run(again)
    assert again.started == ["simulator moving seed-7"]
    assert "0.25 (better in 2 of 2)" in bench.printed


def test_a_lost_run_is_done_and_said_to_be_lost(bench: Bench) -> None:
    runner = PlayedRunner()
    runner.coverage["simulator base seed-13"] = 0.6
    bench.run(runner)
    assert "simulator base seed-13 lost: 60.0% of 100 frames tracked, ATE 4.000 m over those" in bench.printed
    assert "2, 1 lost" in bench.printed
    again = PlayedRunner()
    bench.run(again)
    assert again.started == []


def test_a_run_without_a_report_has_failed_whatever_it_says(bench: Bench) -> None:
    class Silent(PlayedRunner):
        def start(self, run: PlannedRun, folder: Path) -> RunningRun:
            running = super().start(run, folder)
            (folder / "report.json").unlink()
            return running

    with pytest.raises(FailedRunsError, match="4 of 4"):
        bench.run(Silent())
    assert "report.json: no such report" in bench.printed


def test_ctrl_c_keeps_what_has_ended_and_stops_what_goes_on(bench: Bench) -> None:
    runner = PlayedRunner({"simulator base seed-13": KeyboardInterrupt()})
    with pytest.raises(InterruptedBenchError, match="after 2 of 4 runs") as raised:
        bench.run(runner, table="never-asked-for")
    assert raised.value.exit_code == 130
    assert [run.stopped for run in runner.runs] == [False, False, True]
    assert "0.25 (better in 1 of 1)" in bench.printed
    assert not (bench.folder / PLAN[2].folder).exists()
    again = PlayedRunner()
    bench.run(again)
    assert again.started == ["simulator base seed-13", "simulator moving seed-13"]


def test_ctrl_c_before_anything_ended_says_so(bench: Bench) -> None:
    with pytest.raises(InterruptedBenchError, match="after 0 of 4 runs"):
        bench.run(PlayedRunner({PLAN[0].name: KeyboardInterrupt()}))
    bench.run(PlayedRunner())


def test_what_a_killed_benchmark_left_half_done_is_done_anew(bench: Bench) -> None:
    bench.run(PlayedRunner(), PLAN[:1])
    half = bench.folder / PLAN[1].folder
    half.mkdir(parents=True)
    (half / "session.mcap").write_text("half")
    again = PlayedRunner()
    bench.run(again)
    assert again.started == [run.name for run in PLAN[1:]]
    assert not (half / "session.mcap").exists()


def test_another_configuration_never_overwrites_what_went_through(bench: Bench) -> None:
    bench.run(PlayedRunner())
    other = plan_runs(
        BenchRequest(variants=stage_variants("base,moving"), seeds=(7, 13), settings=("slam.features=900",))
    )
    runner = PlayedRunner()
    with pytest.raises(InputError, match=r"base/seed-7: was run with slam\.features = 2000 instead of 900"):
        bench.run(runner, other)
    assert runner.started == []
    assert len(read_bench(bench.folder).runs) == 4


def test_several_jobs_overlap_and_show_no_speed(bench: Bench) -> None:
    runner = PlayedRunner(looks=2)
    most: list[int] = []
    schedule = Schedule(PLAN, KeptRuns(bench.folder), runner, jobs=3, on_look=lambda now: most.append(len(now.running)))
    schedule.drive()
    assert max(most) == 3
    assert [run.measures.frames_per_s for run in schedule.bench_runs if run.measures] == [None] * 4
    alone = Schedule(PLAN, KeptRuns(bench.folder), PlayedRunner())
    alone.recall()
    assert [run.measures.frames_per_s for run in alone.bench_runs if run.measures] == [None] * 4


def test_the_time_left_counts_only_what_was_run_now(bench: Bench) -> None:
    Schedule(PLAN[:1], KeptRuns(bench.folder), PlayedRunner()).drive()
    now_s = iter([0.0, 10.0, 10.0, 10.0, 20.0, 20.0])
    left: list[float | None] = []
    schedule = Schedule(
        PLAN[:3],
        KeptRuns(bench.folder),
        PlayedRunner(looks=1),
        on_look=lambda now: left.append(now.left_s),
        clock=lambda: next(now_s),
    )
    schedule.recall()
    schedule.drive()
    # Half a run after 10 s, a whole one after 10, one and a half after 10, two after 20.
    assert left == pytest.approx([30.0, 10.0, 10.0 / 1.5 * 0.5, 0.0])


def test_the_page_gets_the_table_and_the_failures(bench: Bench, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# Page\n<!-- stages: begin --><!-- stages: end -->\nend\n")
    runner = PlayedRunner({"simulator moving seed-7": RunEnd("slam: gone", 3.0)})
    with pytest.raises(FailedRunsError):
        bench.run(runner, page=page, table="stages", command="kinemap bench --table stages")
    text = page.read_text()
    assert text.startswith("# Page\n<!-- stages: begin -->\n`kinemap bench --table stages`\n")
    assert text.endswith("<!-- stages: end -->\nend\n")
    assert "| simulator | moving | seed-7 | failed: slam: gone |" in text
    assert "| simulator | moving / base | 1 | 0.25 (better in 1 of 1) |" in text


def test_a_failure_on_the_page_does_not_say_where_the_input_lies(bench: Bench, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("")
    source = tmp_path / "03"
    source.mkdir()
    plan = plan_runs(BenchRequest((str(source),), stage_variants("base")))
    runner = PlayedRunner({plan[0].name: RunEnd(f"camera: image {source}/000012.png: broken", 3.0)})
    with pytest.raises(FailedRunsError):
        bench.run(runner, plan, page=page, table="stages")
    assert "failed: camera: image 03/000012.png: broken" in page.read_text()
    assert str(tmp_path) not in page.read_text()
    assert f"{source}/000012.png" in bench.printed


def test_other_code_is_told_of(bench: Bench) -> None:
    bench.run(PlayedRunner())
    file = bench.folder / PLAN[0].folder.with_name("seed-7.json")
    file.write_text(json.dumps(json.loads(file.read_text()) | {"code": "older"}))
    bench.run(PlayedRunner())
    assert "1 of these runs are of an earlier state of the program." in bench.printed


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    with pytest.raises(InputError, match="no benchmark's folder"):
        bench_folder(tmp_path)
    with pytest.raises(InputError, match=r"mine\.txt: is a file"):
        bench_folder(tmp_path / "mine.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_one_benchmark_a_folder_at_a_time(bench: Bench) -> None:
    with reserved(bench.folder), pytest.raises(InputError, match="another benchmark is at work in it"):
        bench.run(PlayedRunner())
    bench.run(PlayedRunner())
    shutil.rmtree(bench.folder)


@pytest.mark.parametrize("half", ["{", "[]", "{}", '{"failure": ""}'])
def test_a_note_of_a_run_that_was_cut_off_has_the_run_done_again(bench: Bench, half: str) -> None:
    bench.run(PlayedRunner())
    (bench.folder / PLAN[0].folder).with_name(f"{PLAN[0].folder.name}.json").write_text(half)
    again = PlayedRunner()
    bench.run(again)
    assert again.started == [PLAN[0].name]


def test_a_benchmarks_own_code_is_none_of_what_its_runs_are_made_by() -> None:
    root = Path(services.__path__[0])
    for prefix in _CODE_OF_NO_RUN:
        assert any(str(file.relative_to(root)).startswith(prefix) for file in root.rglob("*.py")), prefix
