# SPDX-License-Identifier: Apache-2.0
"""Rounds of 500 m through the simulated town: the three stages side by side, with and without loop closing.

`python -m tests.benchmark.slam.simulated_loops --drives FOLDER [--seeds 1-10] [--kinds static,parked,heavy]
[--jobs 2] [--keep FOLDER]`
renders the drives that are not in the folder yet. Objects and who of them moves are the simulator's own, so that the
engine alone is judged; `static`: no traffic, cars parked at the kerbs; `parked`: they fill all lanes but the camera's
own; `heavy`: a third of the image moves. Error after Sim(3) alignment; a run that tracked less than 95 % of its frames
is lost and counts as the worst. A camera that was lost on the way closes the round by joining its two maps. Without
loop closing only stage `moving` is run. Over sections of 25 m, each aligned for itself, one sees what the landmarks
give: the whole round's error is that of how the loop spreads its correction.
"""

from pathlib import Path

import numpy as np

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.benchmark_passes import is_lost, median_ate_m, metres, parser_of, run_groups
from tests.benchmark.slam.engine_pass import EnginePass, PassReport
from tests.benchmark.slam.kept_passes import KeptPasses
from tests.benchmark.slam.section_error import section_error_m
from tests.benchmark.slam.sequence_part import SequencePart
from tests.benchmark.slam.simulated_drives import add_drive_arguments, simulated_drive
from tests.benchmark.slam.trajectory_picture import draw_trajectories

STAGES = ("base", "dynamic", "moving")
JUDGED = "moving"
SECTION_M = 25.0
HEADER = (
    "traffic",
    "stage",
    "runs",
    "lost",
    "closed in (by a loop, by joining maps)",
    "ATE, median",
    "best and worst",
    "without loops",
    "times `base`, median",
    "no worse than `base` in",
    "over 25 m, median",
    "better there than `dynamic` in",
)


def row(kind: str, stage: str, reports: dict[str, list[PassReport]]) -> list[str]:
    """A stage's line of the table; a ratio to `base` is of the same drive."""
    with_loops, without = reports[f"{kind} {stage}"], reports.get(f"{kind} {stage} without loops")
    kept = [report.ate_m for report in with_loops if not is_lost(report)]
    loops = sum(report.loops_closed > 0 for report in with_loops)
    joined = sum(report.maps_joined > 0 and not report.loops_closed for report in with_loops)
    ratios = [
        np.inf if is_lost(own) else own.ate_m / base.ate_m if not is_lost(base) else 0.0
        for own, base in zip(with_loops, reports[f"{kind} base"], strict=True)
    ]
    sections = {of: [section_error_m(each, SECTION_M) for each in reports.get(f"{kind} {of}", ())] for of in STAGES}
    better = sum(own < other for own, other in zip(sections[stage], sections["dynamic"], strict=False))
    return [
        kind,
        stage,
        str(len(with_loops)),
        str(sum(map(is_lost, with_loops))),
        f"{loops + joined} ({loops}, {joined})",
        metres(median_ate_m(with_loops)),
        f"{metres(min(kept))}, {metres(max(kept))}" if kept else "-",
        metres(median_ate_m(without)) if without else "-",
        "-" if stage == "base" else f"{np.median(ratios):.2f}",
        "-" if stage == "base" else str(sum(ratio <= 1 for ratio in ratios)),
        metres(float(np.median(sections[stage]))),
        "-" if stage == "dynamic" or not sections["dynamic"] else str(better),
    ]


def main() -> None:
    """Run every drive in every stage."""
    parser = parser_of(__doc__)
    add_drive_arguments(parser, "1-10")
    parser.add_argument("--kinds", default="static,parked,heavy")
    parser.add_argument("--stages", default=",".join(STAGES), help="base must be among them: the others are compared")
    parser.add_argument("--only-with-loops", action="store_true", help="leave out the passes without loop closing")
    parser.add_argument("--keep", type=Path, help="folder of finished passes: started again, it goes on from there")
    parser.add_argument("--picture", type=Path, help="PNG of the trajectories beside the truth")
    given = parser.parse_args()
    stages = given.stages.split(",")
    groups = {}
    for kind in given.kinds.split(","):
        folders = {seed: simulated_drive(kind, seed, given.drives) for seed in given.seeds}
        for stage in stages:
            for loops in (1, 0) if stage == JUDGED and not given.only_with_loops else (1,):
                groups[f"{kind} {stage}{'' if loops else ' without loops'}"] = [
                    EnginePass((SequencePart(folder),), stage, {"loop_closing": loops}, f"{kind} {stage}, seed {seed}")
                    for seed, folder in folders.items()
                ]
    reports = run_groups(groups, given.jobs, KeptPasses(given.keep) if given.keep else None)
    rows = [row(kind, stage, reports) for kind in given.kinds.split(",") for stage in stages]
    command = f"python -m tests.benchmark.slam.simulated_loops --kinds {given.kinds} --stages {given.stages}"
    command += f"{' --only-with-loops' if given.only_with_loops else ''} ({len(given.seeds)} seeds)"
    put("slam-simulated-loops", command, markdown_table(HEADER, rows))
    if given.picture is not None:
        drawn = [report for name, of_name in reports.items() if "without" not in name for report in of_name]
        draw_trajectories(drawn, given.picture)


if __name__ == "__main__":
    main()
